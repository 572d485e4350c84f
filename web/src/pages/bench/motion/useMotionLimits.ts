import { useQuery } from "@tanstack/react-query";
import { api } from "../../../api/client";
import type { AxisAddress } from "../../../api/motion";
import type { Device } from "../../../api/queries";
import { familyOf } from "../../../families/families";
import type { TopRegister } from "../../../families/family";
import { type AxisScale, toSteps } from "../../../lib/units";

/** Where no family says which register it is. */
const USUAL: TopRegister = { name: "VMAX" };

/** Where neither the register nor the dividers are known yet: slow enough for any motor. */
const CAREFUL_PPS = 1000;

/** What the register holds; null where nobody knows. */
async function look({ device, axis }: AxisAddress, { name, kept }: TopRegister) {
  if (kept === undefined)
    return await api.GET("/api/v1/devices/{device}/registers/{name}", { path: { device, name }, query: { axis } });
  const known = await api.GET("/api/v1/devices/{device}/registers", {
    path: { device },
    query: { axis, group: [kept], kept: true },
  });
  return known.find((reading) => reading.name === name) ?? null;
}

/** The fastest that the axis is set to go [pps]: V_MAX or VMAX of a chip, AP 4 of a module; looked at now and then. */
export function useTopSpeed(at: AxisAddress, device: Device, scale: AxisScale, enabled: boolean): number {
  const said = familyOf(device)?.top ?? USUAL;
  const top = typeof said === "function" ? said(device, at.axis) : said;
  const register = useQuery({
    queryKey: ["register", at.device, at.axis, top?.name],
    queryFn: () => (top ? look(at, top) : null),
    enabled: enabled && top !== null,
    refetchInterval: 5000,
  });
  const value = register.data?.value ?? Number.NaN;
  const chip = top?.pps ? Math.abs(value) * top.pps(scale.clockHz) : toSteps(value, "chip", scale, "velocity");
  const pps = register.data?.unit === "pps" ? value : chip;
  return Number.isFinite(pps) && pps > 0 ? pps : CAREFUL_PPS;
}
