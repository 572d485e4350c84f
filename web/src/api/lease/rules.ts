import free from "./free.json";

const SAFE = new Set(["GET", "HEAD", "OPTIONS"]);
const DRY_RUN = /^\/api\/v1\/devices\/[^/]+\/profile$/;

/** The server's own list of calls that need no lease; templates as in its schema. */
const FREE = free.map((call) => new RegExp(`^${call.replace(/\{[^}]*\}/g, "[^/]+")}$`));

/**
 * Whether a request changes the bench, so that the question for it is asked before it is sent. The server decides: its
 * refusal opens the same question, and this only spares the way.
 */
export function changesBench(method: string, address: string): boolean {
  const { pathname, searchParams } = new URL(address);
  if (SAFE.has(method)) return false;
  if (method === "PUT" && DRY_RUN.test(pathname) && searchParams.get("dry_run") === "true") return false;
  return !FREE.some((pattern) => pattern.test(`${method} ${pathname}`));
}
