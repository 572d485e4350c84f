import { useMutation, useQueryClient } from "@tanstack/react-query";
import { api } from "../../api/client";

export type Action =
  | { do: "run"; address: number | null }
  | { do: "debug"; mode: "run" | "over" | "out"; breakpoints: number[]; fromStart: boolean }
  | { do: "pause" | "stop" | "step" | "reset" };

const DOING: Readonly<Record<Action["do"], string>> = {
  run: "Running the program",
  debug: "Running by single steps",
  pause: "Pausing the program",
  stop: "Stopping the program",
  step: "Doing one command",
  reset: "Resetting the program",
};

/** What starts, steps and stops the program of a device; one after another, in the order in which they were asked for. */
export function useRun(device: string) {
  const queries = useQueryClient();
  const run = useMutation({
    scope: { id: `program of ${device}` },
    mutationFn: async (action: Action) => {
      const params = { path: { device } };
      if (action.do === "run") {
        await api.POST("/api/v1/devices/{device}/program/run", { ...params, body: { address: action.address } });
      } else if (action.do === "debug") {
        await api.POST("/api/v1/devices/{device}/program/debug", {
          ...params,
          body: { mode: action.mode, breakpoints: action.breakpoints, from_start: action.fromStart },
        });
      } else if (action.do === "pause") await api.DELETE("/api/v1/devices/{device}/program/debug", params);
      else await api.POST(`/api/v1/devices/{device}/program/${action.do}`, params);
    },
    onSettled: () => void queries.invalidateQueries({ queryKey: ["devices"] }),
  });
  return { run, doing: run.variables ? DOING[run.variables.do] : "" };
}
