import { useQuery } from "@tanstack/react-query";
import { api, unwrap } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";
import type { Device } from "../../../api/queries";
import { type Family, familyOf } from "../../../lib/family";
import { type AxisScale, toSteps } from "../../../lib/units";

interface TopRegister {
  name: string;
  /** pps of one unit of it; by the axis's dividers where none is said */
  pps?: (clockHz: number) => number;
  /** it cannot be read: it is asked for among what the server knows of this group */
  kept?: string;
}

/**
 * The register of the highest velocity by family. A TMC4361's counts 1/256 pps whatever else is set (DS-TMC4361 8), a
 * TMC5xxx's fCLK / 2^24 (TMC5160A data sheet, 12.1).
 */
const TOP: Record<Family, TopRegister> = {
  pmul: { name: "V_MAX" },
  sramp: { name: "VMAX", pps: () => 1 / 256 },
  sixpoint: { name: "VMAX", pps: (clockHz) => clockHz / 2 ** 24, kept: "ramp" },
  module: { name: "maximum_positioning_speed" },
};

/** Where neither the register nor the dividers are known yet: slow enough for any motor. */
const CAREFUL_PPS = 1000;

/** What the register holds; null where nobody knows. */
async function look({ device, axis }: AxisAddress, { name, kept }: TopRegister) {
  if (kept === undefined)
    return unwrap(
      await api.GET("/api/v1/devices/{device}/registers/{name}", {
        params: { path: { device, name }, query: { axis } },
      }),
    );
  const known = unwrap(
    await api.GET("/api/v1/devices/{device}/registers", {
      params: { path: { device }, query: { axis, group: [kept], kept: true } },
    }),
  );
  return known.find((reading) => reading.name === name) ?? null;
}

/** The fastest that the axis is set to go [pps]: V_MAX or VMAX of a chip, AP 4 of a module; looked at now and then. */
export function useTopSpeed(at: AxisAddress, model: Device["model"], scale: AxisScale, enabled: boolean): number {
  const top = TOP[familyOf(model) ?? "pmul"];
  const register = useQuery({
    queryKey: ["register", at.device, at.axis, top.name],
    queryFn: () => look(at, top),
    enabled,
    refetchInterval: 5000,
  });
  const value = register.data?.value ?? Number.NaN;
  const chip = top.pps ? Math.abs(value) * top.pps(scale.clockHz) : toSteps(value, "chip", scale, "velocity");
  const pps = register.data?.unit === "pps" ? value : chip;
  return Number.isFinite(pps) && pps > 0 ? pps : CAREFUL_PPS;
}
