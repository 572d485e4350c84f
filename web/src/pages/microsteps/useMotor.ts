import { type UseMutationResult, type UseQueryResult, useMutation, useQuery } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";
import { type AxisAddress, motion } from "../../api/motion";
import type { Device } from "../../api/queries";
import { useWork, type Work } from "../../lib/useWork";

const LIVE_MS = 200;
const TURNS = 2;

export interface Motor {
  at: AxisAddress;
  live: UseQueryResult<Schemas["AxisStateOut"]>;
  run: Work<unknown>;
  stop: UseMutationResult<unknown, Error, void>;
  connected: boolean;
  turns: number;
}

/** The motor whose table is designed: its state, a shuttle to try the table with, and the way to stop it. */
export function useMotor(device: Device | undefined, axis: number): Motor {
  const id = device?.id ?? "";
  const connected = device?.state === "connected";
  const at = { device: id, axis };
  const live = useQuery({
    queryKey: ["axis", id, axis],
    queryFn: ({ signal }) => api.GET("/api/v1/devices/{device}/axes/{axis}", { path: at, signal }),
    enabled: connected,
    refetchInterval: LIVE_MS,
  });
  const run = useWork(async () => {
    const info = device?.axes[axis];
    const here = live.data?.position ?? 0;
    const way = TURNS * (info?.full_steps_per_rev ?? 200) * (info?.microsteps_per_full_step ?? 64);
    // towards zero, where a stage has its middle or its start: away from it there may be a switch
    return motion.shuttle(at, { first: here, second: here > 0 ? here - way : here + way, dwell_s: 0.2 });
  });
  const stop = useMutation({
    mutationFn: async () => {
      await motion.stop(at, "ramp");
      await motion.endShuttle(at);
    },
  });
  return { at, live, run, stop, connected, turns: TURNS };
}
