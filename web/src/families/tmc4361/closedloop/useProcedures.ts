import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useEffect } from "react";
import { api, type Schemas } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";
import { STOP_EVENT } from "../../../shell/stopEverything";

export type CalibrationState = Schemas["CalibrationState"];
export type ResponseState = Schemas["ResponseState"];

const CLOSELY_MS = 200;
const NOW_AND_THEN_MS = 4000;

interface Calls<State, Start> {
  get: (signal: AbortSignal) => Promise<State>;
  start: (body: Start) => Promise<State>;
  abort: () => Promise<State>;
}

/** A procedure of an axis: how far it is, looked at closely while it runs, and how it is begun and ended. */
function useProcedure<State extends { state: string }, Start>(
  key: readonly unknown[],
  enabled: boolean,
  calls: Calls<State, Start>,
) {
  const queries = useQueryClient();
  const query = useQuery({
    queryKey: key,
    queryFn: ({ signal }) => calls.get(signal),
    enabled,
    refetchInterval: (now) => (now.state.data?.state === "running" ? CLOSELY_MS : NOW_AND_THEN_MS),
    staleTime: 0,
  });
  const take = (state: State) => queries.setQueryData(key, state);
  const start = useMutation({ mutationFn: calls.start, onSuccess: take });
  const abort = useMutation({ mutationFn: () => calls.abort(), onSuccess: take });
  const { refetch } = query;
  useEffect(() => {
    // a stop ends every procedure: the page should not say for seconds that it still runs
    const look = () => void refetch();
    window.addEventListener(STOP_EVENT, look);
    return () => window.removeEventListener(STOP_EVENT, look);
  }, [refetch]);
  return {
    state: query.data,
    running: query.data?.state === "running",
    start: (body: Start) => {
      abort.reset();
      start.mutate(body);
    },
    abort: () => abort.mutate(),
    starting: start.isPending,
    error: start.error ?? abort.error ?? query.error,
    dismiss: () => {
      start.reset();
      abort.reset();
    },
  };
}

const path = ({ device, axis }: AxisAddress) => ({ path: { device, axis } });

export function useCalibration(at: AxisAddress, enabled: boolean) {
  const url = "/api/v1/devices/{device}/axes/{axis}/closed-loop-calibration" as const;
  return useProcedure<CalibrationState, Schemas["CalibrationStart"]>(
    ["closed-loop-calibration", at.device, at.axis],
    enabled,
    {
      get: (signal) => api.GET(url, { ...path(at), signal }),
      start: (body) => api.POST(url, { ...path(at), body }),
      abort: () => api.DELETE(url, path(at)),
    },
  );
}

export function useStepResponse(at: AxisAddress, enabled: boolean) {
  const url = "/api/v1/devices/{device}/axes/{axis}/step-response" as const;
  return useProcedure<ResponseState, Schemas["StepResponseStart"]>(["step-response", at.device, at.axis], enabled, {
    get: (signal) => api.GET(url, { ...path(at), signal }),
    start: (body) => api.POST(url, { ...path(at), body }),
    abort: () => api.DELETE(url, path(at)),
  });
}

export function useDisturbance(at: AxisAddress, enabled: boolean) {
  const url = "/api/v1/devices/{device}/axes/{axis}/disturbance" as const;
  return useProcedure<ResponseState, Schemas["DisturbanceStart"]>(["disturbance", at.device, at.axis], enabled, {
    get: (signal) => api.GET(url, { ...path(at), signal }),
    start: (body) => api.POST(url, { ...path(at), body }),
    abort: () => api.DELETE(url, path(at)),
  });
}

export type Calibrating = ReturnType<typeof useCalibration>;
export type Responding = ReturnType<typeof useStepResponse> | ReturnType<typeof useDisturbance>;
