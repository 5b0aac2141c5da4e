// A document in hand: undo, drafts that outlive the window and the program, saves.
import { json, send } from "./server";
import type { Session } from "./session";

/** How long after a change it is kept as a draft, ms. */
const SOON_MS = 400;

interface Shown {
  version: string | null;
  saved: string | null;
  draft: string | null;
  stale_draft: string | null;
}

export class Held<T> {
  value: T;
  private version: string | null = null;
  private readonly before: string[] = [];
  private readonly after: string[] = [];
  private timer = 0;
  private isDirty = false;
  /** Hears after every change, also by undo, and after saves; `said` is for the person. */
  changed: (said: string) => void = () => {};
  failed: (why: string) => void = () => {};

  /** `parse` makes a value of the file's text, `print` the text of a value. */
  constructor(
    readonly id: string,
    private readonly session: Session,
    private readonly empty: () => T,
    private readonly parse: (text: string) => T,
    private readonly print: (value: T) => string,
  ) {
    this.value = empty();
  }

  /** Reads what is saved, or what was not saved the last time. */
  async load() {
    const shown = await json<Shown>(`document/${this.id}`);
    this.version = shown.version;
    this.isDirty = shown.draft !== null;
    const text = shown.draft ?? shown.saved;
    this.value = text === null ? this.empty() : this.parse(text);
    if (shown.stale_draft !== null) {
      this.failed("What was not saved the last time belongs to an older version of the file, and was put aside; it stays in .workbench/draft until the next change.");
    }
    this.changed(shown.draft !== null ? "Restored what was not saved." : "");
  }

  get dirty(): boolean {
    return this.isDirty;
  }

  /** Changes the value in place, as one step that can be undone. */
  change(change: (value: T) => void) {
    const was = this.print(this.value);
    change(this.value);
    if (this.print(this.value) === was) return;
    this.before.push(was);
    this.after.length = 0;
    this.touched();
  }

  undo() {
    this.step(this.before, this.after);
  }

  redo() {
    this.step(this.after, this.before);
  }

  private step(from: string[], to: string[]) {
    const text = from.pop();
    if (text === undefined) return;
    to.push(this.print(this.value));
    this.value = this.parse(text);
    this.touched();
  }

  private touched() {
    this.isDirty = true;
    clearTimeout(this.timer);
    this.timer = window.setTimeout(() => void this.keep(), SOON_MS);
    this.changed("Not saved yet.");
  }

  /** Keeps the value as a draft; whether that was done. */
  private async keep(): Promise<boolean> {
    clearTimeout(this.timer);
    try {
      await send("PUT", `draft/${this.id}?${this.session.words(this.version)}`, new Blob([this.print(this.value)], { type: "text/plain" }));
      return true;
    } catch (error) {
      this.failed(`Not kept: ${(error as Error).message}`);
      return false;
    }
  }

  /** Writes the file. */
  async save() {
    if (!(await this.keep())) return;
    try {
      const answer = await send("POST", `save/${this.id}?${this.session.words(this.version)}`, null);
      const { version, is_changed } = (await answer.json()) as { version: string | null; is_changed: boolean };
      this.version = version;
      this.isDirty = false;
      this.failed("");
      this.changed(is_changed ? "Saved." : "Saved; the file says the same as before.");
    } catch (error) {
      this.failed(`Not saved: ${(error as Error).message}`);
    }
  }

  /** Goes back to what is saved. */
  async discard() {
    clearTimeout(this.timer);
    await send("POST", `discard/${this.id}?${this.session.words(this.version)}`, null);
    this.before.length = this.after.length = 0;
    await this.load();
  }
}
