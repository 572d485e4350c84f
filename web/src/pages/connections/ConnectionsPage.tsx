import { Button, Group, Skeleton, Text, TextInput } from "@mantine/core";
import { IconPlugConnected, IconPlus } from "@tabler/icons-react";
import { useEffect, useRef, useState } from "react";
import { type Device, useCatalog, useDevices } from "../../api/queries";
import { EmptyState } from "../../lib/EmptyState";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { useSelection } from "../../live/selection";
import css from "./connections.module.css";
import { DeviceEntry } from "./DeviceEntry";
import { DeviceForm } from "./DeviceForm";
import { type Draft, draftOf, newDraft } from "./draft";
import { Found } from "./Found";
import { RegisterMaps } from "./RegisterMaps";
import { freeName, linkText } from "./words";

/** What the form works on: a new device, or one that exists. `serial` tells one opening from the next. */
interface Open {
  serial: number;
  device: Device | null;
  draft: Draft;
}

/** From so many devices on they are searched. */
const MANY = 6;

/** All devices: what state their links are in, and how to get more of them. */
export default function ConnectionsPage() {
  const devices = useDevices();
  const catalog = useCatalog();
  const chip = catalog.data?.find(({ kind }) => kind === "chip");
  const module = catalog.data?.find(({ kind }) => kind === "module");
  const selection = useSelection();
  const [open, setOpen] = useState<Open | null>(null);
  const panel = useRef<HTMLElement>(null);
  const serial = open?.serial ?? 0;

  // On a narrow screen the form opens below the list, out of sight.
  useEffect(() => {
    if (serial > 0 && window.matchMedia("(max-width: 64em)").matches) panel.current?.scrollIntoView();
  }, [serial]);

  const show = (draft: Draft, device: Device | null = null) =>
    setOpen((now) => ({ serial: (now?.serial ?? 0) + 1, draft, device }));
  const [filter, setFilter] = useState("");
  const words = filter.toLowerCase().split(/\s+/);
  const shown = (devices.data ?? []).filter((device) => {
    const said = [device.name, device.model, device.state, linkText(device.link)].join(" ").toLowerCase();
    return words.every((word) => said.includes(word));
  });
  const names = (devices.data ?? []).filter((device) => device.id !== open?.device?.id).map((device) => device.name);

  return (
    <div className={css.page}>
      <div className="row between mb-8">
        <h1 className="m-0 text-16">Connections</h1>
        <Button
          leftSection={<IconPlus size={14} aria-hidden />}
          disabled={!chip}
          onClick={() => chip && show(newDraft(chip))}
        >
          Add a device
        </Button>
      </div>
      <div className={`${css.columns} columns until-62 gap-12`}>
        <div className="stack gap-8">
          {devices.isError && (
            <ProblemAlert error={devices.error} doing="Looking for devices" retry={() => void devices.refetch()} />
          )}
          {devices.isPending && <Loading />}
          {devices.data?.length === 0 && (
            <div className={`${css.box} pad card`}>
              <EmptyState title="No device yet" icon={<IconPlugConnected size={22} />}>
                <Text size="sm" className="dim" maw={420}>
                  An emulated device needs no hardware and behaves like the real one, motor and switches included. A
                  module answers on a serial port, over TCP or on CAN; a chip speaks its datagrams at an SPI bus or over
                  TCP.
                </Text>
                <Group justify="center">
                  {chip && (
                    <Button size="sm" onClick={() => show({ ...newDraft(chip), name: "bench" })}>
                      Add an emulated {chip.title}
                    </Button>
                  )}
                  {module && (
                    <>
                      <Button size="sm" onClick={() => show({ ...newDraft(module), name: "drive" })}>
                        Add an emulated {module.title}
                      </Button>
                      <Button size="sm" variant="default" onClick={() => show(newDraft(module, "serial"))}>
                        Connect a module
                      </Button>
                    </>
                  )}
                </Group>
              </EmptyState>
            </div>
          )}
          {(devices.data?.length ?? 0) >= MANY && (
            <TextInput
              type="search"
              aria-label="Filter the devices"
              placeholder="Words of name, model, link or state"
              value={filter}
              onChange={(event) => setFilter(event.currentTarget.value)}
            />
          )}
          {filter !== "" && shown.length === 0 && (
            <Text size="sm" className="dim" role="status">
              No device has all of these words.
            </Text>
          )}
          {shown.map((device) => (
            <DeviceEntry
              key={device.id}
              device={device}
              selected={selection.device?.id === device.id}
              edited={open?.device?.id === device.id}
              onUse={() => selection.select(device.id, 0)}
              onEdit={() => show(draftOf(device), device)}
              onRemoved={() => setOpen((now) => (now?.device?.id === device.id ? null : now))}
            />
          ))}
        </div>
        <aside className={`${css.side} stack gap-8`} ref={panel} aria-label="Add or edit a device">
          {open && (
            <DeviceForm
              key={open.serial}
              device={open.device}
              initial={open.draft}
              names={names}
              onClose={() => setOpen(null)}
              onSaved={(saved) => {
                // A new name gives a new id: whoever worked on the device goes on doing so.
                if (open.device && selection.device?.id === open.device.id) selection.select(saved.id, selection.axis);
                else if (!open.device && devices.data?.length === 0) selection.select(saved.id, 0);
                setOpen(null);
              }}
            />
          )}
          {catalog.data && <Found onAdd={show} names={names} models={catalog.data} />}
          <RegisterMaps
            onAdd={(name) => {
              const model = catalog.data?.find((each) => each.name === name);
              if (model) show({ ...newDraft(model), name: freeName(name, names) });
            }}
          />
        </aside>
      </div>
    </div>
  );
}

function Loading() {
  return (
    <div role="status" aria-busy="true" aria-label="Looking for devices">
      <Skeleton height={92} mb="sm" radius="sm" />
      <Skeleton height={92} radius="sm" />
    </div>
  );
}
