import { TraceBuffer } from "./TraceBuffer";

export interface TelemetryRequest {
  device: string;
  channels: readonly string[];
  rateHz: number;
  /** what the page keeps, and asks back for after a reload [s] */
  keepS: number;
}

/** What the columns of a device may take; what is kept gets shorter before a channel is left out. */
const MOST_BYTES = 64e6;

export function telemetryUrl(request: TelemetryRequest, origin: string): string {
  const url = new URL(`/api/v1/devices/${encodeURIComponent(request.device)}/telemetry`, origin);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  url.searchParams.set("channels", request.channels.join(","));
  url.searchParams.set("rate_hz", String(request.rateHz));
  url.searchParams.set("history_s", String(request.keepS));
  return url.href;
}

/** An empty buffer for what a request asks to keep. */
export function bufferFor({ channels, rateHz, keepS }: TelemetryRequest): TraceBuffer {
  const rows = Math.ceil(keepS * rateHz * 1.05) + 64;
  // a buffer is twice as long as what it keeps
  const most = Math.floor(MOST_BYTES / (2 * 8 * (channels.length + 1)));
  return new TraceBuffer(channels, Math.min(most, rows));
}
