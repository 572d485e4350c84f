import createClient from "openapi-fetch";
import { conditions } from "../live/conditions";
import { gate } from "./lease/bench";
import { changesBench } from "./lease/rules";
import { ApiError, type Problem, problemOf } from "./problem";
import type { components, paths } from "./schema";

export { ApiError, type Problem, problemOf };
export type Schemas = components["schemas"];

/**
 * Everything on the REST side goes through here, typed by the server's own schema. What changes the bench waits at the
 * gate until the bench is ours.
 */
export const api = createClient<paths>({ baseUrl: "", fetch: gate.fetch });

// What changes something may move a motor.
api.use({
  onRequest({ request }) {
    if (changesBench(request.method, request.url)) conditions.commanded();
  },
  onResponse({ request }) {
    if (changesBench(request.method, request.url)) conditions.commanded();
  },
});

// A server on a network has forgotten our session (it was started anew): the page itself asks for the token.
api.use({
  onResponse({ response }) {
    if (response.status === 401) window.location.reload();
  },
});

/** The data of an openapi-fetch answer, or an ApiError. */
export function unwrap<T>(answer: { data?: T; error?: unknown; response: Response }): T {
  if (answer.error !== undefined || answer.data === undefined) throw new ApiError(problemOf(answer.error));
  return answer.data;
}
