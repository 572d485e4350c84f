import { Button, Chip, Group, Progress, TextInput } from "@mantine/core";
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

/** What is asked unless one chooses: the rate at delivery, and the fastest that the manual names. */
const USUAL = ["9600", "115200"];

/** Asks a port for modules, rate by rate and address by address, and lists what answers. */
export function Probe({ onAdd }: { onAdd: (found: Found) => void }) {
  const { state, start, abort } = useProbe();
  const [port, setPort] = useState("");
  const [bauds, setBauds] = useState<string[]>(USUAL);
  const [text, setText] = useState("1");
  const [asked, setAsked] = useState(false);
  const addresses = parseAddresses(text);
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
          });
        }}
        noValidate
      >
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
          label="Addresses"
          placeholder="1-4, 7"
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
              asked on <span className="num">{probe.port}</span>
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
                    address <span className="num">{found.address}</span>,{" "}
                    {found.baud === null ? (
                      "no baud rate"
                    ) : (
                      <>
                        <span className="num">{fixed(found.baud)}</span> baud
                      </>
                    )}
                    {found.model === null && ", no driver for it here"}
                  </span>
                </span>
                <Button
                  size="compact-xs"
                  disabled={found.model === null}
                  aria-label={`Add ${found.version} at address ${found.address}`}
                  onClick={() => onAdd(found)}
                >
                  Add
                </Button>
              </li>
            ))}
          </ul>
        </div>
      )}
    </section>
  );
}
