import type { Schemas } from "../../../api/client";
import { api } from "../../../api/client";
import { lowerBound } from "../../../plots/series";

/** A predicted ramp in typed columns; `time` counts from `startedAtS`. */
export interface PredictedRamp {
  startedAtS: number;
  durationS: number;
  time: Float64Array;
  position: Float64Array;
  velocity: Float64Array;
}

function columns(prediction: Schemas["Prediction"]): PredictedRamp {
  return {
    startedAtS: prediction.started_at_s,
    durationS: prediction.duration_s,
    time: Float64Array.from(prediction.time_s),
    position: Float64Array.from(prediction.position),
    velocity: Float64Array.from(prediction.velocity_pps),
  };
}

/** The predicted position at a device time; NaN outside of the ramp. */
export function positionAt(ramp: PredictedRamp, deviceTimeS: number): number {
  const at = deviceTimeS - ramp.startedAtS;
  const after = lowerBound(ramp.time, at);
  if (at < 0 || after >= ramp.time.length) return Number.NaN;
  if (after === 0) return ramp.position[0] as number;
  const [t0 = 0, t1 = 0] = [ramp.time[after - 1], ramp.time[after]];
  const [p0 = 0, p1 = 0] = [ramp.position[after - 1], ramp.position[after]];
  return t1 > t0 ? p0 + ((p1 - p0) * (at - t0)) / (t1 - t0) : p1;
}

/**
 * The predicted ramp of one axis, fetched when a move starts. The part behind the newest sample is drawn from
 * telemetry; this is what is still to come, for as long as it holds.
 */
export class PredictionKeeper {
  ramp: PredictedRamp | null = null;
  private askedMs = Number.NEGATIVE_INFINITY;
  private busy = false;

  constructor(
    readonly device: string,
    readonly axis: number,
  ) {}

  async fetch(nowMs = performance.now()): Promise<void> {
    this.askedMs = nowMs;
    if (this.busy) return;
    this.busy = true;
    try {
      const path = { device: this.device, axis: this.axis };
      this.ramp = columns(await api.GET("/api/v1/devices/{device}/axes/{axis}/prediction", { path }));
    } catch {
      // without an answer there is nothing to foretell; the banner says that the server is gone
      this.ramp = null;
    } finally {
      this.busy = false;
    }
  }

  /**
   * The ramp, if it is still the one in force: telemetry's newest prediction must lie on it. A stop or a write has
   * changed the motion otherwise; then ask again, at most twice a second.
   */
  inForce(newestS: number, predictedNow: number, nowMs: number): PredictedRamp | null {
    if (Number.isNaN(predictedNow)) return null;
    const ramp = this.ramp;
    if (ramp && newestS > ramp.startedAtS + ramp.durationS) return null;
    const expected = ramp ? positionAt(ramp, newestS) : Number.NaN;
    // Between two points of the ramp a straight line is off by far less than this many microsteps.
    if (Math.abs(expected - predictedNow) <= 16) return ramp;
    if (nowMs - this.askedMs > 500) void this.fetch(nowMs);
    return null;
  }
}
