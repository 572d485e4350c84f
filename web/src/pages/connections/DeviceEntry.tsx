import { Badge, Button, Group, Popover, Text } from "@mantine/core";
import { useState } from "react";
import { Link } from "wouter";
import { can, type Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { compact, fixed, frequency } from "../../lib/format";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { StateDot } from "../../lib/StateDot";
import { StartUpButton } from "../../lib/startup/StartUpButton";
import { TierBadge } from "../../lib/TierBadge";
import { useLinkInfo } from "../../lib/wire/useLinkInfo";
import { WireBar } from "../../lib/wire/WireBar";
import css from "./connections.module.css";
import { useLinkSwitch, useRemoveDevice } from "./useConnections";
import { linkText } from "./words";

interface Props {
  device: Device;
  selected: boolean;
  edited: boolean;
  onUse: () => void;
  onEdit: () => void;
  onRemoved: () => void;
}

export function DeviceEntry({ device, selected, edited, onUse, onEdit, onRemoved }: Props) {
  const link = useLinkSwitch(device.id);
  const up = device.state === "connected" || device.state === "connecting";
  return (
    <Card
      className={`${css.device} pad stack gap-8`}
      data-state={device.state}
      data-edited={edited}
      aria-label={device.name}
    >
      <div className={`${css.deviceHead} row wrap gap-8`}>
        <StateDot state={device.state} />
        <h2 className="m-0 text-16">{device.name}</h2>
        <span className="dim">{device.title}</span>
        <TierBadge device={device} />
        {device.demo && (
          <Badge size="xs" variant="default" title="Made for the demo; not kept. Editing keeps it.">
            demo
          </Badge>
        )}
        <span className={`${css.state} dim`}>{stateText(device)}</span>
        <span className={`${css.grow} grow`} />
        <Group gap={6} wrap="nowrap">
          <Button
            size="compact-xs"
            variant={up ? "default" : "filled"}
            loading={link.isPending}
            onClick={() => link.mutate(up ? "disconnect" : "connect")}
          >
            {up ? "Disconnect" : "Connect"}
          </Button>
          {device.about.tier === "full" && (
            <StartUpButton
              size="compact-xs"
              variant="default"
              disabled={device.state !== "connected"}
              device={device.id}
              axes={null}
              axisNames={device.axes.map((axis) => axis.name)}
            />
          )}
          <Button size="compact-xs" variant="default" onClick={onEdit}>
            Edit
          </Button>
          <Remove device={device} onRemoved={onRemoved} />
        </Group>
      </div>
      <dl className="facts lines-24 m-0">
        <div>
          <dt>Link</dt>
          <dd>{linkText(device.link)}</dd>
        </div>
        {can(device, "registers") && (
          <div>
            <dt>Clock</dt>
            <dd className="num">{frequency(device.clock_hz)}</dd>
          </div>
        )}
        <div>
          <dt>Samples</dt>
          <dd>
            <span className="num">up to {compact(device.rate_max_hz)} /s</span>
            {device.chip_timed ? ", the device's own time" : ", the server's time"}
          </dd>
        </div>
        <Wire device={device} />
      </dl>
      <ul className={`${css.axes} grid m-0 text-12 rule-top`}>
        {device.axes.map((axis) => (
          <li key={axis.index}>
            <b>{axis.name}</b>
            <span title="full steps a turn × microsteps a full step, as the chip is set">
              <span className="num">
                {axis.full_steps_per_rev} ×{" "}
                {axis.microsteps_per_full_step === null ? "?" : compact(axis.microsteps_per_full_step)}
              </span>{" "}
              µsteps/rev
            </span>
            {axis.gear_ratio !== 1 && (
              <span>
                gear <span className="num">{compact(axis.gear_ratio)} : 1</span>
              </span>
            )}
            <span>
              {axis.travel_mm_per_rev === null ? (
                "rotary"
              ) : (
                <>
                  <span className="num">{compact(axis.travel_mm_per_rev)}</span> mm/rev
                </>
              )}
            </span>
          </li>
        ))}
      </ul>
      {device.problem && <ProblemAlert error={device.problem} />}
      {device.notes.map((note) => (
        <Text key={note} size="xs" role="status">
          Note: {note}.
        </Text>
      ))}
      {link.isError && <ProblemAlert error={link.error} onClose={() => link.reset()} />}
      <Text size="xs" className="flex wrap gap-12">
        {selected ? (
          <span className="dim">the pages show this device</span>
        ) : (
          <button type="button" className="plain underlined accent" onClick={onUse}>
            Show it on every page
          </button>
        )}
        {can(device, "motion") && (
          <Link href="/first-run" className="underlined accent" onClick={onUse}>
            First run
          </Link>
        )}
        <Link href="/" className="underlined accent" onClick={onUse}>
          Bench
        </Link>
        {can(device, "parameters") ? (
          <Link href="/parameters" className="underlined accent" onClick={onUse}>
            Parameters
          </Link>
        ) : (
          <Link href="/registers" className="underlined accent" onClick={onUse}>
            Registers
          </Link>
        )}
        <Link href="/console" className="underlined accent" onClick={onUse}>
          Console
        </Link>
      </Text>
    </Card>
  );
}

/** A link that was there and went looks for itself; what it shows meanwhile is nothing new. */
function stateText(device: Device): string {
  return device.state === "connecting" && device.problem ? "lost, reconnecting" : device.state;
}

/** Calls a second on the wire, used and possible, and who else is on it. */
function Wire({ device }: { device: Device }) {
  const link = useLinkInfo(device);
  if (!link.data) return null;
  const incidents = Object.entries(link.data.counts.incidents).reduce(
    (sum, [kind, count]) => (kind === "opened" ? sum : sum + count), // opening a port is none that anybody minds
    0,
  );
  return (
    <div className={css.wireFact}>
      <dt>Wire</dt>
      <dd>
        <WireBar link={link.data} old={device.state !== "connected"} />
        {incidents > 0 && (
          <span className="dim">
            {" · "}
            <span className="num">{fixed(incidents)}</span> {incidents === 1 ? "incident" : "incidents"}
          </span>
        )}
        {link.data.shared_with.length > 0 && (
          <span className="dim"> · shared with {link.data.shared_with.join(", ")}</span>
        )}
      </dd>
    </div>
  );
}

/** Removing asks first, and says what goes with it. */
function Remove({ device, onRemoved }: { device: Device; onRemoved: () => void }) {
  const [asking, setAsking] = useState(false);
  const remove = useRemoveDevice(device.id);
  return (
    <Popover opened={asking} onChange={setAsking} width={280} position="bottom-end" withArrow trapFocus shadow="md">
      <Popover.Target>
        <Button size="compact-xs" variant="default" onClick={() => setAsking(true)}>
          Remove
        </Button>
      </Popover.Target>
      <Popover.Dropdown aria-label={`Remove ${device.name}?`}>
        <Text size="sm" fw={600}>
          Remove {device.name}?
        </Text>
        <Text size="sm" my={6}>
          Motion that was started here is stopped and the connection is forgotten
          {device.emulated ? "; the emulated device and what it holds go with it" : "; the device keeps what it holds"}.
        </Text>
        {remove.isError && <ProblemAlert error={remove.error} doing="Removing" />}
        <Group gap="xs" mt="xs">
          <Button
            size="compact-sm"
            loading={remove.isPending}
            onClick={() => remove.mutate(undefined, { onSuccess: onRemoved })}
          >
            Remove
          </Button>
          <Button size="compact-sm" variant="default" data-autofocus onClick={() => setAsking(false)}>
            Keep
          </Button>
        </Group>
      </Popover.Dropdown>
    </Popover>
  );
}
