// Where one begins: what each page does, needs and writes, and what to run next.
import { element } from "pages/elements";
import type { Desk, Tool } from "./desk";
import type { About, Need } from "./server";

/** Whether a page lacks something that it cannot do without. */
export const waits = (page: About) => page.needs.some((need) => !need.is_there && !need.is_optional);

export function needs(list: Need[]): HTMLElement {
  const row = (need: Need) => {
    const made = element("li", { class: need.is_there ? "there" : need.is_optional ? "" : "lacks" },
      need.what, " ", element("code", {}, need.path), ...(need.is_there ? [] : [` — from ${need.made_by}${need.is_optional ? "; not needed" : ""}`]));
    return made;
  };
  return element("ul", { class: "needs" }, ...list.map(row));
}

export function start(desk: Desk, isBuilt: (id: string) => boolean): Tool {
  const { overview } = desk;
  const intro = element("p", {}, overview.manifest
    ? `Take ${overview.manifest.take} of session ${overview.manifest.session}. What only people can do is done here; then `
    : "This folder has no take.json: it can be used for photographs. Then ", element("code", {}, "just take TAKE"), " goes on.");
  const noRun = overview.has_run ? [] : [element("p", { class: "quiet" }, "No run was named: start with ", element("code", {}, "workbench TAKE --run out/take/NAME"), " to see images, cameras and wrinkles (RUN below).")];
  const pages = overview.pages.map((page) => {
    const name = isBuilt(page.id) ? element("a", { href: `#${page.id}` }, page.title) : page.title;
    return element("article", {}, element("h2", {}, name), element("p", {}, `${page.does}.`), needs(page.needs),
      element("p", { class: "quiet" }, "Writes ", element("code", {}, page.writes), "; next: ", element("code", {}, page.next)));
  });
  return { element: element("div", { class: "start" }, intro, ...noRun, ...pages), busy: false, held: null, keys: {}, close: () => {} };
}
