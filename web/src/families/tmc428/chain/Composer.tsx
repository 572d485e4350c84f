import { Badge, Button, Select } from "@mantine/core";
import { IconSend } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import { useState } from "react";
import { Link } from "wouter";
import { api } from "../../../api/client";
import { type Device, useCatalogModel } from "../../../api/queries";
import { Card } from "../../../lib/Card";
import { NumberField } from "../../../lib/NumberField";
import { ProblemAlert } from "../../../lib/ProblemAlert";
import { type FieldRow, unpackField } from "../../../lib/rows/bits";
import { useWork } from "../../../lib/useWork";
import classes from "./Chain.module.css";
import { type Behind, BITS, binary, composable, datagram, frame, holds, put } from "./composer";

/** A cover datagram by the fields of a driver's register, and its answer by name. */
export function Composer({ device }: { device: Device }) {
  const [chosen, setChosen] = useState<string | null>(null);
  const drivers = device.drivers;
  const driver = drivers.find((one) => one.device === chosen) ?? drivers[0];
  return (
    <Card
      title="Cover datagram"
      note={driver ? "sent once, over the bits of one driver" : ""}
      actions={
        drivers.length > 1 && (
          <Select
            aria-label="To the driver"
            w={220}
            data={drivers.map((one) => ({ value: one.device, label: `axis ${one.axis} · ${one.name}` }))}
            value={driver?.device ?? null}
            onChange={setChosen}
          />
        )
      }
    >
      {driver ? (
        <Datagram key={driver.device} driver={driver} connected={device.state === "connected"} />
      ) : (
        <p className="hint m-0">
          No driver of this chain is a device yet. Add it under <Link to="/connections">Connections</Link>, as a driver
          behind a controller: then its registers can be written from here, and have pages of their own.
        </p>
      )}
    </Card>
  );
}

function Datagram({ driver, connected }: { driver: Behind; connected: boolean }) {
  const catalog = useCatalogModel(driver.model);
  const [name, setName] = useState<string | null>(null);
  const [edited, setEdited] = useState<Readonly<Record<string, number>>>({});
  const ready = connected && driver.state === "connected";
  const registers = useQuery({
    queryKey: ["registers", driver.device, "composer"],
    queryFn: ({ signal }) =>
      api.GET("/api/v1/devices/{device}/registers", { path: { device: driver.device }, query: { kept: true }, signal }),
    enabled: ready,
  });
  const tagged = catalog.data?.tagged ?? null;
  const rows = composable(catalog.data?.rows ?? []);
  const row = rows.find((one) => one.name === name) ?? rows[0];
  const heldOf = (register: string) => registers.data?.find((one) => one.name === register)?.raw;
  const word = row ? (edited[row.name] ?? heldOf(row.name) ?? 0) : 0;
  const bits = row && tagged ? datagram(row, word, tagged) : 0;

  const send = useWork(
    () =>
      api.POST("/api/v1/devices/{device}/exchange", { path: { device: driver.device }, body: { frame: frame(bits) } }),
    {
      onSuccess: () => {
        if (row) setEdited(({ [row.name]: _sent, ...rest }) => rest);
        void registers.refetch();
      },
    },
  );

  if (catalog.isError)
    return <ProblemAlert error={catalog.error} doing={`Reading the registers of a ${driver.title}`} />;
  if (!row || !tagged) {
    return (
      <p className="hint m-0">
        {catalog.isPending ? "reading" : `A ${driver.title} takes no datagrams that this chain could carry.`}
      </p>
    );
  }
  const other = (field: string) => {
    for (const one of rows) {
      const part = one.fields.find((candidate) => candidate.name === field);
      const held = part && (edited[one.name] ?? heldOf(one.name));
      if (part && held !== undefined) return unpackField(held, part);
    }
    return null;
  };
  const change = (field: FieldRow, value: number) => setEdited({ ...edited, [row.name]: put(word, field, value) });
  const known = edited[row.name] === undefined && heldOf(row.name) !== undefined;
  return (
    <div className="grid gap-8">
      <div className="inline gap-8">
        <Select
          label="Register"
          w={160}
          data={rows.map((one) => one.name)}
          value={row.name}
          onChange={(value) => value !== null && setName(value)}
        />
        <span className="hint">{row.help}</span>
      </div>
      <div className={classes.composer}>
        {row.fields
          .filter((field) => holds(field.when, word, row, other))
          .map((field) => (
            <Entry
              key={field.name}
              field={field}
              value={unpackField(word, field)}
              onChange={(value) => change(field, value)}
            />
          ))}
      </div>
      <div className="inline gap-8">
        <span className="hint">{BITS} bits</span>
        <code className="num" role="img" aria-label={`datagram ${binary(bits)}`}>
          {binary(bits)}
        </code>
        <span className="hint">
          {known ? "as it was written last" : heldOf(row.name) === undefined ? "what it holds is not known" : "changed"}
        </span>
        <Button
          className="push"
          leftSection={<IconSend size={14} aria-hidden />}
          disabled={!ready}
          loading={send.isPending}
          onClick={() => send.mutate()}
        >
          Send
        </Button>
      </div>
      {!ready && <p className="hint m-0">{driver.name} is not connected: nothing can be sent to it.</p>}
      {send.isError && <ProblemAlert error={send.error} doing="Sending the datagram" onClose={send.reset} />}
      {send.data && <Answer decoded={send.data.decoded} />}
    </div>
  );
}

function Entry({ field, value, onChange }: { field: FieldRow; value: number; onChange: (value: number) => void }) {
  const names = Object.entries(field.values).filter(
    ([number]) => Number(number) >= field.minimum && Number(number) <= field.maximum,
  );
  if (names.length > 0) {
    return (
      <Select
        label={field.name}
        title={field.help}
        data={names.map(([number, text]) => ({ value: number, label: `${number} · ${text}` }))}
        value={String(value)}
        onChange={(chosen) => chosen !== null && onChange(Number(chosen))}
      />
    );
  }
  return (
    <NumberField
      label={field.name}
      title={field.help}
      value={value}
      min={field.minimum}
      max={field.maximum}
      integer
      onChange={onChange}
    />
  );
}

/** What the driver sent back while it got its word: its flags, and what was selected before. */
function Answer({ decoded }: { decoded: Record<string, unknown> }) {
  const flags = Object.entries((decoded.flags ?? {}) as Record<string, boolean>);
  const values = Object.entries((decoded.answer ?? {}) as Record<string, number>);
  return (
    <div className="inline gap-8" role="status">
      <span className="hint">It answered</span>
      {values.map(([name, value]) => (
        <span key={name} className="num">
          {name} {value}
        </span>
      ))}
      {flags.map(([name, on]) => (
        <Badge key={name} variant={on ? "filled" : "default"}>
          {name} {on ? 1 : 0}
        </Badge>
      ))}
      {values.length === 0 && <span className="hint">its flags; what else it showed is not known</span>}
    </div>
  );
}
