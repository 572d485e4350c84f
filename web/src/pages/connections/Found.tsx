import { ActionIcon, Button, CopyButton, Tooltip } from "@mantine/core";
import { IconCheck, IconCopy } from "@tabler/icons-react";
import type { Schemas } from "../../api/client";
import { ProblemAlert } from "../../lib/ProblemAlert";
import css from "./connections.module.css";
import { type Draft, newDraft } from "./draft";
import type { Model } from "./models";
import { portText } from "./PortField";
import { Probe } from "./Probe";
import { usePorts } from "./useConnections";
import { freeName } from "./words";

type Port = Schemas["Port"];

interface Props {
  onAdd: (draft: Draft) => void;
  names: readonly string[];
}

const MODULE = "pd42-1241";

/** What could be connected: emulators, serial ports and the modules on them, and how to serve one elsewhere. */
export function Found({ onAdd, names }: Props) {
  const ports = usePorts();
  const emulators = ports.data?.filter((port) => port.kind === "emulator") ?? [];
  const serial = ports.data?.filter((port) => port.kind === "serial") ?? [];
  const addSerial = (port: string, baud?: number, address?: number) => {
    const draft = newDraft(MODULE, "serial");
    onAdd({
      ...draft,
      name: freeName("pd42", names),
      module: {
        ...draft.module,
        serialPort: port,
        baud: baud === undefined ? "" : String(baud),
        address: address === undefined ? "" : String(address),
      },
    });
  };
  const addBoard = (port: string) => {
    const draft = newDraft("tmc4361", "landungsbruecke");
    onAdd({ ...draft, name: freeName("tmc4361", names), module: { ...draft.module, serialPort: port } });
  };
  return (
    <>
      <section className={css.box} aria-label="Found on this machine">
        <h2>Found on this machine</h2>
        {ports.isError && (
          <ProblemAlert error={ports.error} doing="Looking for ports" retry={() => void ports.refetch()} />
        )}
        <ul className={css.ports}>
          {serial.map((port) => (
            <SerialPort key={port.name} port={port} onAdd={() => addSerial(port.name)} />
          ))}
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
        </ul>
        {ports.isSuccess && (
          <p className={css.note}>
            {serial.length === 0 ? "No serial port found; this list looks again by itself. " : ""}
            TMC428 and TMC4210 speak SPI: behind a serial adapter, bridge their 4-byte datagrams to TCP.
          </p>
        )}
      </section>
      <Probe
        onAdd={(found) =>
          found.board === null ? addSerial(found.port, found.baud ?? undefined, found.address) : addBoard(found.port)
        }
      />
      <section className={css.box} aria-label="A device in another process">
        <h2>A device in another process</h2>
        <p className={css.note}>Serve an emulated one to any client, then connect to it like to hardware:</p>
        <Command text="stepscope emulate pd42-1241 --tcp 127.0.0.1:4242" />
        <Button
          size="compact-xs"
          variant="default"
          mt={8}
          onClick={() => {
            const draft = newDraft(MODULE, "tcp");
            onAdd({ ...draft, name: freeName("remote", names), module: { ...draft.module, tcpPort: "4242" } });
          }}
        >
          Connect to 127.0.0.1:4242
        </Button>
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

function SerialPort({ port, onAdd }: { port: Port; onAdd: () => void }) {
  return (
    <li>
      <span>
        <b className="num">{port.name}</b>
        <span className={css.portNote}>{portText(port)}</span>
      </span>
      <Button size="compact-xs" variant="default" aria-label={`Add a module on ${port.name}`} onClick={onAdd}>
        Add
      </Button>
    </li>
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
