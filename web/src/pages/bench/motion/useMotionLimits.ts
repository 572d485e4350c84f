import { useQuery } from "@tanstack/react-query";
import { api, unwrap } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";
import type { Device } from "../../../api/queries";
import { familyOf } from "../../../lib/family";
import { type AxisScale, toSteps } from "../../../lib/units";

/** Where neither the register nor the dividers are known yet: slow enough for any motor. */
const CAREFUL_PPS = 1000;

/** The fastest that the axis is set to go [pps]: V_MAX of a chip, AP 4 of a module; looked at now and then. */
export function useTopSpeed(at: AxisAddress, model: Device["model"], scale: AxisScale, enabled: boolean): number {
  const name = familyOf(model) === "module" ? "maximum_positioning_speed" : "V_MAX";
  const register = useQuery({
    queryKey: ["register", at.device, at.axis, name],
    queryFn: async () =>
      unwrap(
        await api.GET("/api/v1/devices/{device}/registers/{name}", {
          params: { path: { device: at.device, name }, query: { axis: at.axis } },
        }),
      ),
    enabled,
    refetchInterval: 5000,
  });
  const value = register.data?.value ?? Number.NaN;
  const pps = register.data?.unit === "pps" ? value : toSteps(value, "chip", scale, "velocity");
  return Number.isFinite(pps) && pps > 0 ? pps : CAREFUL_PPS;
}
