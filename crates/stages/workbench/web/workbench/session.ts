// Whether this window may write: one does at a time.
import { ask, send } from "./server";

const EVERY_MS = 5000;

export class Session {
  /** Random, so that a window is known again as long as it is open. */
  readonly page = crypto.getRandomValues(new Uint32Array(3)).join("-");
  holds = true;
  /** Hears when this window may write, may no longer, or the program is gone. */
  changed: (said: "holds" | "looks" | "gone") => void = () => {};
  private said = "";

  async start() {
    await this.call(false);
    setInterval(() => void this.call(false), EVERY_MS);
    addEventListener("pagehide", () => void send("POST", "here", { page: this.page, leaves: true }).catch(() => {}));
  }

  async takeOver() {
    await this.call(true);
  }

  /** The words that what this window writes goes with. */
  words(base: string | null): string {
    return `page=${this.page}&base=${base ?? ""}`;
  }

  private async call(takesOver: boolean) {
    try {
      this.holds = await ask<boolean>("here", { page: this.page, takes_over: takesOver });
      this.tell(this.holds ? "holds" : "looks");
    } catch {
      this.tell("gone");
    }
  }

  private tell(said: "holds" | "looks" | "gone") {
    if (said !== this.said) this.changed(said);
    this.said = said;
  }
}
