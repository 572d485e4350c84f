const KEY = "stepscope.session";
const NAME = "stepscope.name";
/** What the server takes as a name. */
export const LONGEST_NAME = 60;

/** Not randomUUID: a page on a network address without TLS has none. */
function newId(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** The secret that makes this browser a session: all its tabs are one, and one of them may go on for another. */
function ofThisBrowser(): string {
  if (localStorage.getItem(KEY) === null) localStorage.setItem(KEY, newId());
  return localStorage.getItem(KEY) ?? newId();
}

export const sessionId = ofThisBrowser();

const TAB = "stepscope.tab.";
const tab = TAB + newId();
/** A tab in the background says it every five seconds while the bench is ours; one that crashed never takes it back. */
const FRESH_MS = 12_000;

/** Let the other tabs of this browser know of this one. */
export function sayHere(): void {
  localStorage.setItem(tab, String(Date.now()));
}

/** This tab goes. Returns whether another one is there. */
export function sayGone(): boolean {
  localStorage.removeItem(tab);
  const others = Object.keys(localStorage).filter((key) => key.startsWith(TAB));
  const there = others.filter((key) => Date.now() - Number(localStorage.getItem(key)) < FRESH_MS);
  if (there.length === 0) for (const key of others) localStorage.removeItem(key);
  return there.length > 0;
}

const BROWSERS: readonly (readonly [RegExp, string])[] = [
  [/Edg\//, "Edge"],
  [/OPR\//, "Opera"],
  [/Firefox\//, "Firefox"],
  [/Chrome\//, "Chrome"],
  [/Safari\//, "Safari"],
];
const SYSTEMS: readonly (readonly [RegExp, string])[] = [
  [/Android/, "Android"],
  [/iPhone|iPad/, "iOS"],
  [/Windows/, "Windows"],
  [/Mac OS/, "Mac"],
  [/Linux/, "Linux"],
];

/** What a user is called who has not given a name: "Firefox on Linux". */
export function nameOfBrowser(agent: string): string {
  const find = (table: typeof BROWSERS) => table.find(([pattern]) => pattern.test(agent))?.[1];
  const browser = find(BROWSERS) ?? "Browser";
  const system = find(SYSTEMS);
  return system ? `${browser} on ${system}` : browser;
}

export function savedName(): string | null {
  return localStorage.getItem(NAME);
}

export function userName(): string {
  return savedName() ?? nameOfBrowser(navigator.userAgent);
}

/** Blank: what the browser is called, for good. */
export function saveName(name: string): void {
  const wanted = name.trim().slice(0, LONGEST_NAME);
  localStorage.setItem(NAME, wanted || nameOfBrowser(navigator.userAgent));
}

/** What every request says of who sends it. Header values are ASCII, names are not. */
export function sessionHeaders(): Record<string, string> {
  return { "Stepscope-Session": sessionId, "Stepscope-Name": encodeURIComponent(userName()) };
}
