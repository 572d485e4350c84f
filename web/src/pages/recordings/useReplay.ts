import { useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { api } from "../../api/client";
import { type Replay, useChanges } from "./api";

/** The replay of a recording: begun, looked at while it runs. */
export function useReplay(id: string) {
  const changes = useChanges();
  const queries = useQueryClient();
  const [problem, setProblem] = useState<unknown>(null);
  const key = ["replay", id];
  const query = useQuery<Replay | null>({
    queryKey: key,
    queryFn: () => api.GET("/api/v1/recordings/{recording}/replay", { path: { recording: id } }),
    refetchInterval: ({ state }) => (state.data?.state === "running" ? 300 : false),
  });
  return {
    replay: query.data ?? null,
    problem,
    dismiss: () => setProblem(null),
    start: () => {
      setProblem(null);
      changes.replay(id).then(
        (replay) => queries.setQueryData(key, replay),
        (error: unknown) => setProblem(error),
      );
    },
  };
}
