import createClient, {
  type ClientPathsWithMethod,
  type MethodResponse,
  type ParamsOption,
  type RequestBodyOption,
} from "openapi-fetch";
import { enterWrite } from "../lib/history/aim";
import { conditions } from "../live/conditions";
import { gate } from "./lease/bench";
import { changesBench } from "./lease/rules";
import { ApiError, type Problem, problemOf } from "./problem";
import type { components, paths } from "./schema";

export { ApiError, type Problem, problemOf };
export type Schemas = components["schemas"];

/** Whole answers, failed ones too, for the few who read more of them than their data. */
export const client = createClient<paths>({ baseUrl: "", fetch: gate.fetch });

// What changes something may move a motor.
client.use({
  onRequest({ request }) {
    if (changesBench(request.method, request.url)) conditions.commanded();
  },
  onResponse({ request, response }) {
    if (!changesBench(request.method, request.url)) return;
    conditions.commanded();
    if (response.ok) enterWrite(request.method, request.url);
  },
});

// A server on a network has forgotten our session (it was started anew): the page itself asks for the token.
client.use({
  onResponse({ response }) {
    if (response.status === 401) window.location.reload();
  },
});

type Client = typeof client;
type Method = "get" | "put" | "post" | "patch" | "delete";

/** What an operation takes: its path and query parameters and its body, side by side. */
type Call<Operation> = NonNullable<ParamsOption<Operation>["params"]> &
  RequestBodyOption<Operation> & {
    signal?: AbortSignal;
    fetch?: (request: Request) => Promise<Response>;
    parseAs?: "text";
  };

type Ask<M extends Method> = <P extends ClientPathsWithMethod<Client, M>>(
  path: P,
  ...call: object extends Call<paths[P][M]> ? [Call<paths[P][M]>?] : [Call<paths[P][M]>]
) => Promise<MethodResponse<Client, M, P>>;

function ask<M extends Method>(method: M): Ask<M> {
  return (async (url: string, { path, query, ...rest }: Record<string, unknown> = {}) => {
    const init = { params: { path, query }, ...rest };
    const { data, error, response } = await client.request(method, url as never, init as never);
    // a refusal without a body has no `error`
    if (error !== undefined || !response.ok) throw new ApiError(problemOf(error));
    return data;
  }) as Ask<M>;
}

/**
 * Everything on the REST side goes through here, typed by the server's own schema: the data of an answer (undefined
 * where it has none), or an ApiError. What changes the bench waits at the gate until the bench is ours.
 */
export const api = {
  GET: ask("get"),
  PUT: ask("put"),
  POST: ask("post"),
  PATCH: ask("patch"),
  DELETE: ask("delete"),
};
