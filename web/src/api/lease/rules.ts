import free from "./free.json";

const SAFE = new Set(["GET", "HEAD", "OPTIONS"]);
/** Calls that only look where their query says so. */
const DRY_RUN = /^(PUT \/api\/v1\/devices\/[^/]+\/profile|POST \/api\/v1\/devices\/[^/]+\/(start-up|undo))$/;

/** The server's own list of calls that need no lease; templates as in its schema. */
const FREE = free.map((call) => new RegExp(`^${call.replace(/\{[^}]*\}/g, "[^/]+")}$`));

/**
 * Whether a request changes the bench, so that the question for it is asked before it is sent. The server decides: its
 * refusal opens the same question, and this only spares the way.
 */
export function changesBench(method: string, address: string): boolean {
  const { pathname, searchParams } = new URL(address);
  if (SAFE.has(method)) return false;
  if (DRY_RUN.test(`${method} ${pathname}`) && searchParams.get("dry_run") === "true") return false;
  return !FREE.some((pattern) => pattern.test(`${method} ${pathname}`));
}
