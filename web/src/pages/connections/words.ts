import { compact, fixed } from "../../lib/format";

/** A link in one line. */
export function linkText(link: Record<string, unknown>): string {
  const address = typeof link.address === "number" && link.address !== 1 ? `, address ${link.address}` : "";
  if (link.kind === "tcp") return `tcp ${String(link.host)}:${String(link.port)}${address}`;
  if (link.kind === "serial" || link.kind === "uart") {
    const baud = typeof link.baud === "number" ? ` at ${fixed(link.baud)} baud` : "";
    const node = typeof link.node === "number" && link.node !== 0 ? `, node ${link.node}` : "";
    return `${link.kind} ${String(link.port)}${baud}${address}${node}`;
  }
  if (link.kind === "cover") return `${String(link.device)}, axis ${String(link.axis ?? 0)}`;
  if (link.kind === "spidev") return `spi ${String(link.bus)}.${String(link.device)}`;
  if (link.kind === "can") return `can ${String(link.interface)} ${String(link.channel)}`;
  const scale =
    typeof link.time_scale === "number" && link.time_scale !== 1 ? `, time × ${compact(link.time_scale)}` : "";
  if (typeof link.port === "string") return `evaluation board at ${link.port}`;
  return link.kind === "emulator" ? `emulated in this server${scale}` : String(link.kind);
}

/** `tmc428`, or `tmc428 2` where that is taken. */
export function freeName(wanted: string, names: readonly string[]): string {
  const taken = new Set(names.map((name) => name.toLowerCase()));
  for (let count = 1; ; count += 1) {
    const name = count === 1 ? wanted : `${wanted} ${count}`;
    if (!taken.has(name)) return name;
  }
}
