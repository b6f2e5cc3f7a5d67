// Elements, messages to the person, downloads.

type Child = Node | string;
/** An element: el("button.small", { title: "..." }, "text"). */
export function el<K extends keyof HTMLElementTagNameMap>(
  what: K | `${K}.${string}`,
  attributes: Record<string, string | boolean | number | ((event: Event) => void)> = {},
  ...children: Child[]
): HTMLElementTagNameMap[K] {
  const [tag, ...classes] = what.split(".");
  const element = document.createElement(tag) as HTMLElementTagNameMap[K];
  if (classes.length) element.className = classes.join(" ");
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name, value);
    else if (typeof value === "boolean") element.toggleAttribute(name, value);
    else element.setAttribute(name, String(value));
  }
  element.append(...children);
  return element;
}
export function byId<T extends HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page has no element ${id}`);
  return found as T;
}
/** Sets a text only where it differs: nothing is laid out anew that has not changed. */
export function setText(element: Node, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

interface Line {
  at: Date;
  level: string;
  text: string;
  times: number;
}
export const log: Line[] = [];
const longestLog = 200;

/** One visible line, and the same in the log. */
export function say(level: string, text: string): void {
  const line = text.split("\n")[0].slice(0, 400);
  const last = log[0];
  if (last && last.text === line && last.level === level) {
    last.times++;
    last.at = new Date();
  } else {
    log.unshift({ at: new Date(), level, text: line, times: 1 });
    if (log.length > longestLog) log.pop();
  }
  drawLog();
  if (level === "quiet") return;
  const toasts = byId("toasts");
  for (const toast of [...toasts.children]) if (toast.textContent === line) toast.remove();
  const toast = el("div", { class: `toast ${level}`, role: level === "error" ? "alert" : "status" }, line);
  toasts.append(toast);
  while (toasts.children.length > 3) toasts.firstElementChild?.remove();
  window.setTimeout(() => toast.remove(), level === "error" ? 9000 : 5000);
}
function drawLog(): void {
  const list = byId("log");
  list.replaceChildren(
    ...(log.length
      ? log.map((line) =>
          el("li", { class: line.level }, el("time", {}, line.at.toLocaleTimeString()), ` ${line.text}${line.times > 1 ? ` (${line.times} times)` : ""}`),
        )
      : [el("li.empty", {}, "Nothing has happened yet.")]),
  );
}

export function download(name: string, content: Blob | string, type = "text/plain"): void {
  const url = URL.createObjectURL(typeof content === "string" ? new Blob([content], { type }) : content);
  const link = el("a", { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  window.setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/** 3 digits, with a prefix. */
export function si(value: number, unit: string): string {
  if (!Number.isFinite(value)) return value > 0 ? `∞ ${unit}` : `${value} ${unit}`;
  const size = Math.abs(value);
  const [factor, prefix] = size >= 1e3 ? [1e-3, "k"] : size >= 1 || size === 0 ? [1, ""] : size >= 1e-3 ? [1e3, "m"] : [1e6, "µ"];
  return `${+(value * factor).toPrecision(3)} ${prefix}${unit}`;
}

/** Tabs: buttons with aria-controls. */
export function tabs(bar: HTMLElement, chosen?: (id: string) => void): (id: string) => void {
  const buttons = [...bar.querySelectorAll<HTMLButtonElement>("[role=tab]")];
  const choose = (id: string): void => {
    for (const button of buttons) {
      const on = button.getAttribute("aria-controls") === id;
      button.setAttribute("aria-selected", String(on));
      button.tabIndex = on ? 0 : -1;
      byId(button.getAttribute("aria-controls")!).hidden = !on;
    }
    chosen?.(id);
  };
  for (const [k, button] of buttons.entries()) {
    button.addEventListener("click", () => choose(button.getAttribute("aria-controls")!));
    button.addEventListener("keydown", (event) => {
      const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
      if (!step) return;
      const next = buttons[(k + step + buttons.length) % buttons.length];
      next.focus();
      next.click();
      event.preventDefault();
    });
  }
  return choose;
}
