import createClient from "openapi-fetch";
import type { components, paths } from "./schema";

export type Schemas = components["schemas"];
export type Problem = Schemas["Problem"];

/** Everything on the REST side goes through here, typed by the server's own schema. */
export const api = createClient<paths>({ baseUrl: "" });

// A server on a network has forgotten our session (it was started anew): the page itself asks for the token.
api.use({
  onResponse({ response }) {
    if (response.status === 401) window.location.reload();
  },
});

/** An answer that is a problem+json, as an exception for react-query. */
export class ApiError extends Error {
  readonly problem: Problem;
  constructor(problem: Problem) {
    super(problem.detail);
    this.problem = problem;
  }
}

/** A problem out of whatever a failed call gave: our own JSON, or no answer at all. */
export function problemOf(error: unknown): Problem {
  if (error instanceof ApiError) return error.problem;
  if (typeof error === "object" && error !== null && "detail" in error && "title" in error) return error as Problem;
  return {
    type: "/problems/no-answer",
    title: "The server does not answer",
    status: 0,
    detail: error instanceof Error ? error.message : String(error),
    way_out: "Check that stepscope is still running; this page reconnects by itself.",
    facts: {},
    instance: null,
  };
}

/** The data of an openapi-fetch answer, or an ApiError. */
export function unwrap<T>(answer: { data?: T; error?: unknown; response: Response }): T {
  if (answer.error !== undefined || answer.data === undefined) throw new ApiError(problemOf(answer.error));
  return answer.data;
}
