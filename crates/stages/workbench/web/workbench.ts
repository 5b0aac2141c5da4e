// The workbench: pages for what only people can do, one at a time.
import { element, shortcuts, themeButton } from "pages/elements";
import type { Desk, Tool } from "./workbench/desk";
import { labels } from "./workbench/labels";
import { paint } from "./workbench/paint";
import { picks } from "./workbench/picks";
import { type Overview, json } from "./workbench/server";
import { Session } from "./workbench/session";
import { needs, start, waits } from "./workbench/start";

const TOOLS: Record<string, (desk: Desk) => Promise<Tool>> = { labels, picks, paint };

const byId = (id: string) => document.getElementById(id) as HTMLElement;

/** What stands above the page: who may write, and what went wrong last. */
const told = { standing: "", failure: "" };

function notice() {
  const text = [told.standing, told.failure].filter(Boolean).join("\n");
  byId("notice").textContent = text;
  byId("notice").hidden = !text;
}

function fail(text: string) {
  told.failure = text;
  notice();
}

function say(text: string) {
  byId("state").textContent = text;
}

/** Tells scripts that the page is there. */
function ready() {
  document.body.dataset.ready = "yes";
}

class Shell {
  private tool: Tool | null = null;
  private readonly save = element("button", { type: "button", title: "Save (Ctrl S)" }, "Save");
  private readonly takeOver = element("button", { type: "button", id: "take-over", hidden: true }, "Work here instead");

  constructor(private readonly desk: Desk) {
    this.save.addEventListener("click", () => void this.tool?.held?.save());
    this.takeOver.addEventListener("click", () => void desk.session.takeOver().then(() => location.reload()));
    byId("tools").append(this.takeOver, " ", this.save, " ", themeButton(() => {}));
    byId("take").textContent = desk.overview.take;
    addEventListener("hashchange", () => void this.open());
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("beforeunload", (event) => {
      // The draft is kept; this only asks whether that was meant.
      if (this.tool?.held?.dirty && desk.session.holds) event.preventDefault();
    });
  }

  async open() {
    const id = location.hash.slice(1);
    this.tool?.close();
    this.tool = null;
    fail("");
    say("");
    this.desk.overview = await json<Overview>("overview");
    this.showTabs(id);
    const about = this.desk.overview.pages.find((page) => page.id === id);
    const place = byId("page");
    if (!about || !TOOLS[id]) {
      this.tool = start(this.desk, (page) => page in TOOLS);
    } else if (waits(about)) {
      place.replaceChildren(element("div", { class: "start" }, element("h2", {}, `${about.title} waits for something`), needs(about.needs)));
      this.save.hidden = true;
      ready();
      return;
    } else {
      this.tool = await TOOLS[id](this.desk);
      say(`Writes ${about.writes}; next: ${about.next}`);
    }
    this.save.hidden = !this.tool.held;
    Object.assign(window, { workbench: this.tool });
    place.replaceChildren(this.tool.element);
    this.tool.element.querySelector("canvas")?.focus();
    ready();
  }

  private showTabs(id: string) {
    const tab = (href: string, title: string, page: string, isWaiting: boolean) => {
      const made = element("a", { href, class: isWaiting ? "waits" : "" }, title);
      if (page === id) made.setAttribute("aria-current", "page");
      return made;
    };
    const { pages } = this.desk.overview;
    const tabs = pages.filter((page) => page.id in TOOLS).map((page) => tab(`#${page.id}`, page.title, page.id, waits(page)));
    byId("pages").replaceChildren(tab("#", "Take", "", false), ...tabs);
  }

  standing(said: "holds" | "looks" | "gone") {
    this.takeOver.hidden = said !== "looks";
    this.save.disabled = said !== "holds";
    const texts = {
      holds: "",
      looks: "Another window works on this take; this one only looks.",
      gone: "The program that serves this page has stopped. What you did is kept up to the last change; start it again and open its new address.",
    };
    told.standing = texts[said];
    notice();
  }

  /** Undo, redo and save work everywhere; the page's own keys while nothing is typed. */
  private key(event: KeyboardEvent) {
    if (!(event.ctrlKey || event.metaKey)) return;
    const held = this.tool?.held;
    const actions: Record<string, (() => void) | undefined> = {
      z: () => (event.shiftKey ? held?.redo() : held?.undo()),
      y: () => held?.redo(),
      s: () => void held?.save(),
    };
    const action = actions[event.key.toLowerCase()];
    if (!held || !action) return;
    event.preventDefault();
    action();
  }

  get keys(): Record<string, () => void> {
    return this.tool?.keys ?? {};
  }
}

async function main() {
  const session = new Session();
  const desk: Desk = { session, overview: await json<Overview>("overview"), say, fail };
  document.title = `${desk.overview.take} · workbench`;
  const shell = new Shell(desk);
  session.changed = (said) => shell.standing(said);
  await session.start();
  // Whatever page is open: its keys.
  shortcuts(new Proxy({} as Record<string, () => void>, { get: (_, key) => shell.keys[key as string] }));
  await shell.open();
}

main().catch((error: Error) => {
  fail(error.message);
  document.body.dataset.failed = "yes";
});
