import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api } from "../../api/client";
import { forget } from "../history/history";
import { batchOf, merge, settle } from "./staging";
import { stagedOf, stagingOf, updateStaged } from "./store";
import { rememberWritten } from "./written";

/** Sends a device's staged edits in their order; what failed or was not tried stays staged. */
export function useApply(device: string) {
  const queries = useQueryClient();
  return useMutation({
    mutationFn: async () => {
      const sent = stagedOf(device).edits;
      const result = await api.POST("/api/v1/devices/{device}/registers", {
        path: { device },
        body: { writes: batchOf(sent) },
      });
      const { applied, left } = settle(sent, result);
      updateStaged(device, (now) => ({ edits: merge(now.edits, sent, left), applied, appliedAt: Date.now() }));
      forget(stagingOf(device)); // what was sent is undone as a write
      rememberWritten(device, applied);
      return { applied: applied.length, left: left.length };
    },
    onSettled: () =>
      Promise.all([
        queries.invalidateQueries({ queryKey: ["registers", device] }),
        queries.invalidateQueries({ queryKey: ["devices"] }),
      ]),
  });
}
