import { Button, Chip, Group, NativeSelect, Progress, SegmentedControl, TextInput } from "@mantine/core";
import { useState } from "react";
import type { Schemas } from "../../api/client";
import { fixed } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { parseAddresses } from "./addresses";
import css from "./connections.module.css";
import { SEARCHED } from "./form";
import { PortField } from "./PortField";
import { useProbe } from "./useConnections";

type Found = Schemas["ProbeFound"];
type Kind = "modules" | "chips";

/** Of chips on a UART; modules have none 0. */
const NODES = { lowest: 0, highest: 254 };

/** What is asked unless one chooses: the rate at delivery, and the fastest that the manual names. */
const USUAL = ["9600", "115200"];

interface Props {
  /** a device is to be made of it, as that model */
  onAdd: (found: Found, model: string | null) => void;
  /** what people call a model */
  titleOf: (model: string) => string;
}

/** Asks a port for modules, or for chips on a UART, rate by rate and address by address, and lists what answers. */
export function Probe({ onAdd, titleOf }: Props) {
  const { state, start, abort } = useProbe();
  const [port, setPort] = useState("");
  const [bauds, setBauds] = useState<string[]>(USUAL);
  const [text, setText] = useState("1");
  const [kind, setKind] = useState<Kind>("modules");
  const chips = kind === "chips";
  const [asked, setAsked] = useState(false);
  const addresses = parseAddresses(text, chips ? NODES : undefined);
  const probe = state.data;
  const running = probe?.running === true;
  const wrongPort = asked && port.trim() === "" ? "Choose a port, or type a device name or address" : undefined;
  return (
    <section className={`${css.box} pad card`} aria-label="Look for modules">
      <h2>Look for modules</h2>
      <form
        className="stack gap-8 mb-8"
        onSubmit={(event) => {
          event.preventDefault();
          setAsked(true);
          if (port.trim() === "" || !addresses.ok || bauds.length === 0) return;
          start.mutate({
            port: port.trim(),
            bauds: bauds.map(Number).sort((a, b) => a - b),
            addresses: addresses.list.length > 0 ? addresses.list : null,
            kind,
          });
        }}
        noValidate
      >
        <SegmentedControl
          size="xs"
          aria-label="Whom to look for"
          data={[
            { value: "modules", label: "Modules and boards" },
            { value: "chips", label: "Chips on a UART" },
          ]}
          value={kind}
          onChange={(value) => {
            setKind(value as Kind);
            setText(value === "chips" ? "0-3" : "1");
            setBauds(value === "chips" ? ["115200"] : USUAL);
          }}
        />
        <PortField label="Port or address" value={port} error={wrongPort} onChange={setPort} />
        <fieldset className={css.bauds}>
          <legend className="hint regular">Baud rates</legend>
          <Chip.Group multiple value={bauds} onChange={setBauds}>
            <Group gap={4}>
              {SEARCHED.bauds.map((baud) => (
                <Chip key={baud} value={String(baud)} size="xs" radius="sm" variant="light">
                  {fixed(baud)}
                </Chip>
              ))}
            </Group>
          </Chip.Group>
          {asked && bauds.length === 0 && <p className="m-0 mt-4 fault text-12">Choose at least one rate</p>}
        </fieldset>
        <TextInput
          label={chips ? "Nodes" : "Addresses"}
          placeholder={chips ? "0-3" : "1-4, 7"}
          classNames={{ input: "num", label: "hint regular" }}
          value={text}
          error={addresses.ok ? undefined : addresses.why}
          autoComplete="off"
          onChange={(event) => setText(event.currentTarget.value)}
        />
        <Group gap="xs">
          <Button type="submit" loading={start.isPending} disabled={running}>
            Probe
          </Button>
          {running && (
            <Button variant="default" loading={abort.isPending} onClick={() => abort.mutate()}>
              Abort
            </Button>
          )}
          {addresses.ok && !running && (
            <span className="dim">
              <span className="num">{bauds.length * Math.max(1, addresses.list.length)}</span>{" "}
              {bauds.length * Math.max(1, addresses.list.length) === 1 ? "question" : "questions"}, silence takes
              longest
            </span>
          )}
        </Group>
      </form>
      {start.isError && <ProblemAlert error={start.error} doing={`Probing ${port}`} onClose={() => start.reset()} />}
      {abort.isError && <ProblemAlert error={abort.error} doing="Aborting" onClose={() => abort.reset()} />}
      {state.isError && <ProblemAlert error={state.error} doing="Following the probe" />}
      {probe?.port && (
        <div className="stack gap-4 mt-8">
          <Progress
            value={probe.total === 0 ? 0 : (100 * probe.done) / probe.total}
            size="sm"
            animated={running}
            aria-label="Questions asked"
          />
          <div className="lines-8 hint between" role="status">
            <span>
              <span className="num">
                {probe.done} of {probe.total}
              </span>{" "}
              asked on <span className="num breaks anywhere">{probe.port}</span>
            </span>
            {!running && probe.found.length === 0 && <span>nothing answered</span>}
          </div>
          {probe.message !== "" && <p className="hint m-0 mt-4">{probe.message}</p>}
          <ul className={`${css.ports} list`} aria-label="Modules found">
            {probe.found.map((found) => (
              <li key={`${found.port} ${found.baud} ${found.address}`}>
                <span>
                  <b className="num">{found.version}</b>
                  {found.board !== null && <span className="hint block">{found.board}</span>}
                  <span className="hint block">
                    {found.kind === "chip" ? "node" : "address"} <span className="num">{found.address}</span>,{" "}
                    {found.baud === null ? (
                      "no baud rate"
                    ) : (
                      <>
                        <span className="num">{fixed(found.baud)}</span> baud
                      </>
                    )}
                    {found.model === null && found.candidates.length === 0 && ", no driver for it here"}
                  </span>
                </span>
                <Answered found={found} titleOf={titleOf} onAdd={(model) => onAdd(found, model)} />
              </li>
            ))}
          </ul>
        </div>
      )}
    </section>
  );
}

/** What answered as a device: of a chip that may be several the user says which. */
function Answered({
  found,
  titleOf,
  onAdd,
}: {
  found: Found;
  titleOf: Props["titleOf"];
  onAdd: (model: string) => void;
}) {
  const models = [...new Set([...(found.model === null ? [] : [found.model]), ...found.candidates])];
  const [model, setModel] = useState(models[0] ?? null);
  const where = `${found.version} at ${found.kind === "chip" ? "node" : "address"} ${found.address}`;
  return (
    <Group gap={6} wrap="nowrap">
      {models.length > 1 && (
        <NativeSelect
          size="xs"
          aria-label={`Which chip is ${where}`}
          title="Their lists have a version there and do not tell which number it is"
          data={models.map((name) => ({ value: name, label: titleOf(name) }))}
          value={model ?? ""}
          onChange={(event) => setModel(event.currentTarget.value)}
        />
      )}
      <Button
        size="compact-xs"
        disabled={model === null}
        aria-label={`Add ${where}`}
        onClick={() => model !== null && onAdd(model)}
      >
        Add
      </Button>
    </Group>
  );
}
