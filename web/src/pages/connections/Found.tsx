import { ActionIcon, Button, CopyButton, Tooltip } from "@mantine/core";
import { IconCheck, IconCopy } from "@tabler/icons-react";
import type { Schemas } from "../../api/client";
import { ProblemAlert } from "../../lib/ProblemAlert";
import css from "./connections.module.css";
import { type Draft, freeName, type Model, newDraft } from "./draft";
import { usePorts } from "./useConnections";

type Port = Schemas["Port"];

interface Props {
  onAdd: (draft: Draft) => void;
  names: readonly string[];
}

/** What could be connected: emulators, serial ports, and how to serve a chip from another process. */
export function Found({ onAdd, names }: Props) {
  const ports = usePorts();
  const emulators = ports.data?.filter((port) => port.kind === "emulator") ?? [];
  const serial = ports.data?.filter((port) => port.kind === "serial") ?? [];
  return (
    <>
      <section className={css.box} aria-label="Found on this machine">
        <h2>Found on this machine</h2>
        {ports.isError && (
          <ProblemAlert error={ports.error} doing="Looking for ports" retry={() => void ports.refetch()} />
        )}
        <ul className={css.ports}>
          {emulators.map((port) => (
            <li key={port.name}>
              <span>
                <b>{port.description}</b>
                <span className={css.portNote}>in this server, no hardware needed</span>
              </span>
              <Button
                size="compact-xs"
                variant="default"
                aria-label={`Add an ${port.description}`}
                onClick={() =>
                  onAdd({ ...newDraft(port.model as Model), name: freeName(port.model ?? "emulator", names) })
                }
              >
                Add
              </Button>
            </li>
          ))}
          {serial.map((port) => (
            <li key={port.name}>
              <span>
                <b className="num">{port.name}</b>
                <span className={css.portNote}>
                  {[port.description === port.name ? "serial port" : port.description, usbText(port)]
                    .filter(Boolean)
                    .join(" · ")}
                </span>
              </span>
            </li>
          ))}
        </ul>
        {ports.isSuccess && (
          <p className={css.note}>
            {serial.length === 0 ? "No serial port found; this list looks again by itself. " : ""}
            TMC428 and TMC4210 speak SPI: behind a serial adapter, bridge their 4-byte datagrams to TCP.
          </p>
        )}
      </section>
      <section className={css.box} aria-label="A chip in another process">
        <h2>A chip in another process</h2>
        <p className={css.note}>Serve an emulated chip to any client, then connect to it like to hardware:</p>
        <Command text="stepscope emulate tmc428 --tcp 127.0.0.1:4280" />
        <Button
          size="compact-xs"
          variant="default"
          mt={8}
          onClick={() => onAdd({ ...newDraft("tmc428", "tcp"), name: freeName("remote", names), port: "4280" })}
        >
          Connect to 127.0.0.1:4280
        </Button>
      </section>
    </>
  );
}

function Command({ text }: { text: string }) {
  return (
    <div className={css.command}>
      <code>{text}</code>
      <CopyButton value={text} timeout={1500}>
        {({ copied, copy }) => (
          <Tooltip label={copied ? "Copied" : "Copy"}>
            <ActionIcon size={24} variant="subtle" color="gray" aria-label="Copy the command" onClick={copy}>
              {copied ? <IconCheck size={15} /> : <IconCopy size={15} />}
            </ActionIcon>
          </Tooltip>
        )}
      </CopyButton>
    </div>
  );
}

function usbText(port: Port): string {
  if (port.usb_vid === null || port.usb_vid === undefined || port.usb_pid === null || port.usb_pid === undefined)
    return "";
  const id = [port.usb_vid, port.usb_pid].map((part) => part.toString(16).padStart(4, "0")).join(":");
  return `USB ${id}${port.usb_serial ? ` · ${port.usb_serial}` : ""}`;
}
