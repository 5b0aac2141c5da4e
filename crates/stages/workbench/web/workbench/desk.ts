// What a page gets to work with, and what it gives.
import type { Session } from "./session";
import type { Sheet } from "./sheet";
import type { Overview } from "./server";

export interface Desk {
  session: Session;
  overview: Overview;
  /** Tells the person something in passing. */
  say(text: string): void;
  /** Tells of a failure until the next one, or until it is taken back with "". */
  fail(text: string): void;
}

/** An open page. */
export interface Tool {
  element: HTMLElement;
  /** Its picture, if it has one: tests press where places of it are. */
  sheet?: Sheet;
  /** Whether it waits for an answer. */
  readonly busy: boolean;
  /** The document in hand, if it edits one. */
  held: { undo(): void; redo(): void; save(): Promise<void>; readonly dirty: boolean } | null;
  keys: Record<string, () => void>;
  close(): void;
}
