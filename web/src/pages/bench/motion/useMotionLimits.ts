import { useQuery } from "@tanstack/react-query";
import { api, unwrap } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";
import { type AxisScale, toSteps } from "../../../lib/units";

/** Where neither the register nor the dividers are known yet: slow enough for any motor. */
const CAREFUL_PPS = 1000;

/** The fastest that the axis is set to go [pps], from V_MAX and the pulse divider; looked at now and then. */
export function useTopSpeed(at: AxisAddress, scale: AxisScale, enabled: boolean): number {
  const register = useQuery({
    queryKey: ["register", at.device, at.axis, "V_MAX"],
    queryFn: async () =>
      unwrap(
        await api.GET("/api/v1/devices/{device}/registers/{name}", {
          params: { path: { device: at.device, name: "V_MAX" }, query: { axis: at.axis } },
        }),
      ),
    enabled,
    refetchInterval: 5000,
  });
  const pps = toSteps(register.data?.value ?? Number.NaN, "chip", scale, "velocity");
  return Number.isFinite(pps) && pps > 0 ? pps : CAREFUL_PPS;
}
