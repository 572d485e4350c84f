import { useQuery } from "@tanstack/react-query";
import { api, type Schemas } from "../../api/client";
import type { Device } from "../../api/queries";
import { useCalc } from "../../lib/useCalc";

type AnyQuestion = Schemas["MicrostepDesign"] | Schemas["MslutDesign"];

/** A design's table and its figures, from the calculator. What is not said has the server's defaults. */
export function useDesign<Question extends AnyQuestion, Result>(body: Partial<Question> | null) {
  return useCalc<Partial<Question>, Result>("microstep-table", body, async (question, signal) => {
    const answer = await api.POST("/api/v1/calc/microstep-table", { body: question as unknown as Question, signal });
    return answer as Result;
  });
}

/** The table that the chip holds, asked for every `everyMs`. */
export function useHeld(device: Device | undefined, everyMs: number) {
  const id = device?.id ?? "-";
  return useQuery({
    queryKey: tableKey(id),
    queryFn: ({ signal }) => api.GET("/api/v1/devices/{device}/microstep-table", { path: { device: id }, signal }),
    enabled: device?.state === "connected",
    refetchInterval: everyMs,
  });
}

export function tableKey(device: string) {
  return ["microstep-table", device];
}
