// Elements of pages, without a framework: what is on a page is made once and changed in place.

type Child = Node | string;

/** An element with properties and children. */
export function element<K extends keyof HTMLElementTagNameMap>(
  tag: K,
  properties: Partial<HTMLElementTagNameMap[K]> & { class?: string } = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const made = document.createElement(tag);
  const { class: classes, ...rest } = properties;
  Object.assign(made, rest);
  if (classes) made.className = classes;
  made.append(...children);
  return made;
}

/** A titled group of controls. */
export function group(title: string, ...children: Child[]): HTMLElement {
  const heading = element("h2", {}, title);
  const made = element("section", {}, heading, ...children);
  made.setAttribute("aria-label", title);
  return made;
}

/** A labelled slider and the element that shows its value. */
export interface Slider {
  row: HTMLElement;
  input: HTMLInputElement;
  /** Moves it without telling anybody. */
  show(value: number): void;
}

export interface Range {
  least: number;
  most: number;
  step: number;
  value: number;
  text(value: number): string;
}

export function slider(label: Child, range: Range, changed: (value: number) => void): Slider {
  const input = element("input", { type: "range", min: `${range.least}`, max: `${range.most}`, step: `${range.step}` });
  const shown = element("output", { class: "numbers quiet" });
  const show = (value: number) => {
    input.value = `${value}`;
    shown.textContent = range.text(value);
  };
  input.addEventListener("input", () => {
    shown.textContent = range.text(input.valueAsNumber);
    changed(input.valueAsNumber);
  });
  show(range.value);
  const row = element("label", { class: "slider" }, element("span", { class: "name" }, label), input, shown);
  return { row, input, show };
}

/** Buttons of which one is pressed; the arrow keys go from one to the next. */
export function choice<T extends string>(name: string, options: [T, string][], chosen: T, changed: (value: T) => void) {
  const set = element("div", { class: "choice" });
  set.setAttribute("role", "radiogroup");
  set.setAttribute("aria-label", name);
  const inputs = options.map(([value, label]) => {
    const input = element("input", { type: "radio", name, value, checked: value === chosen });
    input.addEventListener("change", () => changed(value));
    set.append(element("label", {}, input, label));
    return input;
  });
  const show = (value: T) => inputs.forEach((input) => (input.checked = input.value === value));
  return { set, show };
}

/** Keys that work wherever the focus is, except while something is typed or chosen from a list. */
export function shortcuts(keys: Record<string, () => void>) {
  addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const at = event.target as HTMLElement;
    const types = at instanceof HTMLSelectElement || (at instanceof HTMLInputElement && at.type === "text");
    const own = at instanceof HTMLButtonElement || at instanceof HTMLInputElement;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const action = keys[key];
    // The space bar presses buttons.
    if (!action || types || (key === " " && own)) return;
    event.preventDefault();
    action();
  });
}

/** A button that goes from the system's theme to the other one and back; `changed` hears of either's change. */
export function themeButton(changed: () => void): HTMLButtonElement {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const root = document.documentElement;
  const isDark = () => (root.dataset.theme ?? (dark.matches ? "dark" : "light")) === "dark";
  const button = element("button", { type: "button", title: "Light or dark (T)" });
  const show = () => {
    button.textContent = isDark() ? "Light" : "Dark";
    changed();
  };
  button.addEventListener("click", () => {
    root.dataset.theme = isDark() ? "light" : "dark";
    show();
  });
  dark.addEventListener("change", show);
  button.textContent = isDark() ? "Light" : "Dark";
  return button;
}
