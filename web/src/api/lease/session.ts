const KEY = "stepscope.session";
const NAME = "stepscope.name";
/** What the server takes as a name. */
export const LONGEST_NAME = 60;

/** Not randomUUID: a page on a network address without TLS has none. */
function newId(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/**
 * The secret that makes this tab a session of its own. A duplicated tab copies the session storage of the first, so
 * the id lies there only while no page of the tab lives: it is taken out at loading and put back at leaving.
 */
function takeOut(): string {
  const kept = sessionStorage.getItem(KEY);
  sessionStorage.removeItem(KEY);
  return kept ?? newId();
}

export const sessionId = takeOut();

window.addEventListener("pagehide", () => sessionStorage.setItem(KEY, sessionId));
window.addEventListener("pageshow", () => sessionStorage.removeItem(KEY));

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

/** What somebody is called who has not said it: "Firefox on Linux". */
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
