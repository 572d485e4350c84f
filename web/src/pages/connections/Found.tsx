import { ActionIcon, Button, CopyButton } from "@mantine/core";
import { IconCheck, IconCopy } from "@tabler/icons-react";
import type { Schemas } from "../../api/client";
import { ProblemAlert } from "../../lib/ProblemAlert";
import css from "./connections.module.css";
import { type Draft, newDraft } from "./draft";
import { isModule, type Model } from "./models";
import { portText } from "./PortField";
import { Probe } from "./Probe";
import { usePorts } from "./useConnections";
import { freeName } from "./words";

type Port = Schemas["Port"];

interface Props {
  onAdd: (draft: Draft) => void;
  names: readonly string[];
  models: readonly Model[];
}

/** What could be connected: emulators, serial ports and the modules on them, and how to serve one elsewhere. */
export function Found({ onAdd, names, models }: Props) {
  const ports = usePorts();
  const emulators = ports.data?.filter((port) => port.kind === "emulator") ?? [];
  const serial = ports.data?.filter((port) => port.kind === "serial") ?? [];
  const named = (name: string | null | undefined) => models.find((model) => model.name === name);
  const module = models.find(isModule);
  const chips = models.filter((model) => model.datagram_bits === 32 && model.tier === "full");
  const boards = models.find(({ wires }) => wires.some(({ frames }) => frames === "board"));
  const addSerial = (model: Model | undefined, port: string, baud?: number, address?: number) => {
    if (!model) return;
    const [rate, node] = [baud, address].map((value) => (value === undefined ? "" : String(value)));
    const draft = newDraft(model, "serial", { port, baud: rate ?? "", address: node ?? "" });
    onAdd({ ...draft, name: freeName(shortName(model), names) });
  };
  const addUart = (model: Model | undefined, port: string, baud?: number, node?: number) => {
    if (!model) return;
    const rate = baud === undefined ? "" : String(baud);
    const draft = newDraft(model, "uart", {
      port,
      baud: rate,
      ...(model.uart === "node" ? { node: String(node) } : {}),
    });
    onAdd({ ...draft, name: freeName(shortName(model), names) });
  };
  const addBoard = (model: Model | undefined, port: string) => {
    const kind = model?.wires.find(({ frames }) => frames === "board")?.kind;
    if (!model || !kind) return;
    onAdd({ ...newDraft(model, kind, { port }), name: freeName(shortName(model), names) });
  };
  return (
    <>
      <section className={`${css.box} pad card`} aria-label="Found on this machine">
        <h2>Found on this machine</h2>
        {ports.isError && (
          <ProblemAlert error={ports.error} doing="Looking for ports" retry={() => void ports.refetch()} />
        )}
        <ul className={`${css.ports} list`}>
          {serial.map((port) => (
            <SerialPort key={port.name} port={port} onAdd={() => addSerial(module, port.name)} />
          ))}
          {emulators.map((port) => (
            <li key={port.name}>
              <span>
                <b>{port.description}</b>
                <span className="hint block">in this server, no hardware needed</span>
              </span>
              <Button
                size="compact-xs"
                variant="default"
                aria-label={`Add an ${port.description}`}
                onClick={() => {
                  const model = named(port.model);
                  if (model) onAdd({ ...newDraft(model), name: freeName(model.name, names) });
                }}
              >
                Add
              </Button>
            </li>
          ))}
        </ul>
        {ports.isSuccess && (
          <p className="hint m-0 mt-4">
            {serial.length === 0 ? "No serial port found; this list looks again by itself. " : ""}
            {chips.map(({ title }) => title).join(" and ")} speak SPI: behind a serial adapter, bridge their 4-byte
            datagrams to TCP.
          </p>
        )}
      </section>
      <Probe
        titleOf={(name) => named(name)?.title ?? name}
        onAdd={(found, chosen) => {
          if (found.kind === "chip") addUart(named(chosen), found.port, found.baud ?? undefined, found.address);
          else if (found.board !== null) addBoard(named(chosen) ?? boards, found.port);
          else addSerial(named(chosen) ?? module, found.port, found.baud ?? undefined, found.address);
        }}
      />
      <section className={`${css.box} pad card`} aria-label="A device in another process">
        <h2>A device in another process</h2>
        <p className="hint m-0 mt-4">Serve an emulated one to any client, then connect to it like to hardware:</p>
        {module && (
          <Elsewhere
            model={module}
            port="4242"
            onAdd={(draft) => onAdd({ ...draft, name: freeName("remote", names) })}
          />
        )}
        {chips[0] && (
          <Elsewhere
            model={chips[0]}
            port="4280"
            onAdd={(draft) => onAdd({ ...draft, name: freeName("remote", names) })}
          />
        )}
      </section>
    </>
  );
}

/** What comes before the number of a module's variant. */
function shortName({ name }: Model): string {
  return name.split("-")[0] ?? name;
}

/** How to serve an emulated one at a port of this machine, and a connection to it. */
function Elsewhere({ model, port, onAdd }: { model: Model; port: string; onAdd: (draft: Draft) => void }) {
  return (
    <>
      <Command text={`stepscope emulate ${model.name} --tcp 127.0.0.1:${port}`} />
      <Button size="compact-xs" variant="default" mt={8} onClick={() => onAdd(newDraft(model, "tcp", { port }))}>
        Connect to 127.0.0.1:{port}
      </Button>
    </>
  );
}

function SerialPort({ port, onAdd }: { port: Port; onAdd: () => void }) {
  return (
    <li>
      <span>
        <b className="num">{port.name}</b>
        <span className="hint block">{portText(port)}</span>
      </span>
      <Button size="compact-xs" variant="default" aria-label={`Add a module on ${port.name}`} onClick={onAdd}>
        Add
      </Button>
    </li>
  );
}

function Command({ text }: { text: string }) {
  return (
    <div className={`${css.command} raised pad-s row box gap-6 mt-8`}>
      <code>{text}</code>
      <CopyButton value={text} timeout={1500}>
        {({ copied, copy }) => (
          <ActionIcon size={24} aria-label="Copy the command" title={copied ? "Copied" : "Copy"} onClick={copy}>
            {copied ? <IconCheck size={15} /> : <IconCopy size={15} />}
          </ActionIcon>
        )}
      </CopyButton>
    </div>
  );
}
