import type { components } from "./schema";

export type Problem = components["schemas"]["Problem"];

/** An answer that is a problem+json, as an exception for react-query. */
export class ApiError extends Error {
  readonly problem: Problem;
  constructor(problem: Problem) {
    super(problem.detail);
    this.problem = problem;
  }
}

/** What a problem may leave out (RFC 9457): one from a proxy, or of another version of the server, does. */
const LEFT_OUT = { way_out: null, facts: {}, remedies: [], instance: null };

/** The type of a problem that is none of the server's: nobody answered. */
export const NO_ANSWER = "/problems/no-answer";

/** A whole problem out of whatever a failed call gave: a problem+json, or no answer at all. */
export function problemOf(error: unknown): Problem {
  if (error instanceof ApiError) return error.problem;
  if (typeof error === "object" && error !== null && "detail" in error && "title" in error)
    return { ...LEFT_OUT, ...(error as Problem) };
  return {
    ...LEFT_OUT,
    type: NO_ANSWER,
    title: "The server does not answer",
    status: 0,
    detail: error instanceof Error ? error.message : String(error),
    way_out: "Check that stepscope is still running; this page reconnects by itself.",
  };
}
