import { useMutation, useQueryClient } from "@tanstack/react-query";
import { ApiError, type Schemas } from "../../api/client";
import { gate } from "../../api/lease/bench";
import { problemOf } from "../../api/problem";
import { conditions } from "../../live/conditions";

export type Remedy = Schemas["Remedy"];

/** Makes the call that a remedy is, as the server has put it; it waits for the bench like every other change. */
async function apply({ method, path, body }: Remedy): Promise<unknown> {
  conditions.commanded();
  const request = new Request(new URL(path, window.location.origin), {
    method,
    headers: body === null ? {} : { "content-type": "application/json" },
    ...(body === null ? {} : { body: JSON.stringify(body) }),
  });
  const answer = await gate.fetch(request);
  conditions.commanded();
  const said: unknown = answer.status === 204 ? null : await answer.json().catch(() => undefined);
  if (!answer.ok) throw new ApiError(problemOf(said));
  return said;
}

/** The remedies of a place that offers some: one at a time, with the failure of the last. */
export function useRemedies() {
  const queries = useQueryClient();
  return useMutation({ mutationFn: apply, onSettled: () => queries.invalidateQueries() });
}

export type Remedies = ReturnType<typeof useRemedies>;
