import { Autocomplete, type AutocompleteProps } from "@mantine/core";
import type { Schemas } from "../../api/client";
import { usePorts } from "./useConnections";

type Port = Schemas["Port"];

/** A serial port: one that is there, or whatever pyserial takes, typed in. */
export function PortField(props: AutocompleteProps) {
  const ports = usePorts();
  const serial = ports.data?.filter((port) => port.kind === "serial") ?? [];
  const byName = new Map(serial.map((port) => [port.name, port]));
  const renderOption: NonNullable<AutocompleteProps["renderOption"]> = ({ option }) => {
    const port = byName.get(option.value);
    return (
      <span>
        <span className="num">{option.value}</span>
        <span className="hint block">{port && portText(port)}</span>
      </span>
    );
  };
  return (
    <Autocomplete
      classNames={{ input: "num", label: "hint regular" }}
      {...props}
      placeholder="/dev/ttyACM0, socket://host:port, rfc2217://host:port"
      data={serial.map((port) => port.name)}
      // what is there is always offered, whatever is typed
      filter={({ options }) => options}
      renderOption={renderOption}
      comboboxProps={{ width: "max-content", position: "bottom-start" }}
      autoComplete="off"
      spellCheck={false}
    />
  );
}

/** What a port is, where it is plugged in, and who has it. */
export function portText(port: Port): string {
  return [
    port.description === port.name ? "serial port" : port.description,
    usbText(port),
    port.in_use_by.length > 0 ? `in use by ${port.in_use_by.join(", ")}` : "",
  ]
    .filter(Boolean)
    .join(" · ");
}

function usbText(port: Port): string {
  if (port.usb_vid === null || port.usb_vid === undefined || port.usb_pid === null || port.usb_pid === undefined)
    return "";
  const id = [port.usb_vid, port.usb_pid].map((part) => part.toString(16).padStart(4, "0")).join(":");
  return `USB ${id}${port.usb_serial ? ` · ${port.usb_serial}` : ""}`;
}
