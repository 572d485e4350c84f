import { createContext } from "react";

/** `moveBefore` keeps what a frame has loaded; browsers without it load it anew when its panel is moved. */
type Movable = Element & { moveBefore?: (node: Node, before: Node | null) => void };

function put(into: Element, node: Node): void {
  const target = into as Movable;
  if (target.moveBefore && into.isConnected && node.isConnected) target.moveBefore(node, null);
  else into.append(node);
}

/**
 * The boxes that panels are rendered into. A box is lent to whatever shows the panel now, and waits out of sight in
 * between: so a panel keeps its state, and is not rendered anew, wherever it is moved.
 */
export class Hosts {
  private readonly boxes = new Map<string, HTMLDivElement>();
  private readonly waiting = document.createElement("div");

  constructor() {
    this.waiting.hidden = true;
  }

  /** Where boxes wait; it has to be on the page before the first of them is lent. */
  readonly settle = (on: HTMLElement | null): void => {
    if (on) put(on, this.waiting);
  };

  box(id: string, className: string): HTMLDivElement {
    const known = this.boxes.get(id);
    const box = known ?? document.createElement("div");
    box.className = className; // a phone that is turned shows the same panel otherwise
    if (known) return known;
    box.dataset.panel = id;
    this.boxes.set(id, box);
    this.waiting.append(box);
    return box;
  }

  lend(id: string, to: HTMLElement): () => void {
    const box = this.boxes.get(id);
    if (box && box.parentElement !== to) put(to, box);
    return () => {
      if (box?.parentElement === to) put(this.waiting, box);
    };
  }
}

export const HostsContext = createContext<Hosts | null>(null);
