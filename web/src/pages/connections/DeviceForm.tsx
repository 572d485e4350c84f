import { ActionIcon, Button, Group, SegmentedControl, Select, TextInput } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { type FormEvent, useState } from "react";
import type { Device } from "../../api/queries";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { scaleOf } from "../../lib/units";
import css from "./connections.module.css";
import { axisConfigs, clockField, type Draft, linkOf, linkValues, problemsOf, withModel } from "./draft";
import { AxisFold, AxisTable, type Entry, FieldInput, type Row } from "./fields";
import { axisForm, linkForm, NAME, needed, type Values } from "./form";
import { LinkFields } from "./LinkFields";
import { MapFile } from "./MapFile";
import { inMechanics } from "./mechanics";
import { axesText, type Kind, kindsOf, TIERS } from "./models";
import { TestResult } from "./TestResult";
import { useCatalog, useLinkTest, useSaveDevice } from "./useConnections";

interface Props {
  device: Device | null;
  initial: Draft;
  /** of the other devices */
  names: readonly string[];
  onClose: () => void;
  onSaved: (device: Pick<Device, "id">) => void;
}

/** A connection being made or changed. Nothing reaches the server before Test or Save. */
export function DeviceForm({ device, initial, names, onClose, onSaved }: Props) {
  const catalog = useCatalog();
  const [draft, setDraft] = useState(initial);
  const [tried, setTried] = useState(false);
  const [more, setMore] = useState(false);
  const save = useSaveDevice(device ? { device, before: initial } : null);
  const test = useLinkTest();
  const set = (change: Partial<Draft>) => setDraft((now) => ({ ...now, ...change }));

  const all = problemsOf(draft, names);
  const model = draft.model;
  const entry = (prefix: string, values: Values, onChange: (values: Values) => void): Entry => ({
    value: ({ path }) => values[path] ?? "",
    // An empty field is no mistake before one has tried to save; a wrong one is at once.
    problem: (field) =>
      tried || values[field.path]?.trim() || !needed(field) ? all[`${prefix}${field.path}`] : undefined,
    onChange: (field, text) => onChange({ ...values, [field.path]: text }),
  });
  const clock = clockField(model);
  const own = entry("", { name: draft.name, clock_mhz: draft.clockMhz }, ({ name = "", clock_mhz: clockMhz = "" }) =>
    set({ name, clockMhz }),
  );
  const rows = draft.axes.map((axis, index): Row => {
    const replaced = (values: Values) => set({ axes: draft.axes.map((each, at) => (at === index ? values : each)) });
    const id = `axis ${index}`;
    return { id, name: axis.name || id, ...entry(`axes.${index}.`, axis, replaced) };
  });
  const [table, ...folds] = axisForm(model).groups;
  const link = JSON.stringify([draft.model.name, linkOf(draft)]);
  // How a device counts its microsteps is known once it has answered; the mechanics are those that are typed.
  const scales = axisConfigs(draft).map((typed, index) => {
    const axis = device?.axes[index];
    return axis === undefined ? undefined : scaleOf({ ...axis, ...typed, limits: axis.limits }, device?.clock_hz);
  });
  const [testedLink, setTestedLink] = useState("");
  const interrupts = device?.state === "connected" && JSON.stringify([initial.model.name, linkOf(initial)]) !== link;

  function submit(event: FormEvent) {
    event.preventDefault();
    setTried(true);
    const paths = Object.keys(all);
    if (paths.length > 0) {
      if (paths.some((path) => path.startsWith("link."))) setMore(true);
      return;
    }
    save.mutate(draft, { onSuccess: onSaved });
  }

  function runTest() {
    const blocking = Object.keys(all).filter((path) => path !== "name" && !path.startsWith("axes"));
    if (blocking.length > 0) {
      setTried(true);
      return;
    }
    setTestedLink(link);
    test.mutate(draft);
  }

  return (
    <form
      className={`${css.box} pad card`}
      onSubmit={submit}
      noValidate
      aria-label={device ? `Edit ${device.name}` : "Add a device"}
    >
      <div className={`${css.formHead} row between mb-8`}>
        <h2>{device ? `Edit ${device.name}` : "Add a device"}</h2>
        <ActionIcon size={24} aria-label="Close without saving" onClick={onClose}>
          <IconX size={16} />
        </ActionIcon>
      </div>
      <div className={`${css.two} halves start gap-8`}>
        <TextInput
          label="Name"
          placeholder="for example bench"
          ref={focusIfEmpty}
          classNames={{ label: "hint regular" }}
          value={draft.name}
          error={own.problem(NAME)}
          maxLength={80}
          autoComplete="off"
          onChange={(event) => set({ name: event.currentTarget.value })}
        />
        <Select
          label="Model"
          classNames={{ label: "hint regular" }}
          data={(catalog.data ?? [draft.model]).map(({ name, title, axes, tier }) => ({
            value: name,
            label: `${title} · ${axesText(axes)}${TIERS[tier] ? ` · ${TIERS[tier].word}` : ""}`,
          }))}
          searchable
          nothingFoundMessage="No model of that name"
          description={TIERS[model.tier]?.help}
          value={draft.model.name}
          disabled={device !== null}
          onChange={(name) => {
            const chosen = catalog.data?.find((candidate) => candidate.name === name);
            if (chosen) setDraft((now) => withModel(now, chosen));
          }}
        />
      </div>
      {device === null && (
        <MapFile models={catalog.data ?? []} onModel={(chosen) => setDraft((now) => withModel(now, chosen))} />
      )}
      <fieldset className={`${css.group} stack gap-8 m-0 mt-12 rule-top`}>
        <legend>Link</legend>
        <SegmentedControl
          fullWidth
          aria-label="Kind of link"
          data={kindsOf(draft.model)}
          value={draft.kind}
          onChange={(kind) => set({ kind: kind as Kind })}
        />
        <LinkFields
          // what is told of a field is told of this kind's
          key={draft.kind}
          form={linkForm(model, draft.kind)}
          names={rows.map(({ name }) => name)}
          {...entry("link.", linkValues(draft), (values) => set({ links: { ...draft.links, [draft.kind]: values } }))}
          open={more}
          onOpen={setMore}
        />
        {clock && <FieldInput field={clock} {...own} />}
      </fieldset>
      <fieldset className={`${css.group} stack gap-8 m-0 mt-12 rule-top`}>
        <legend>Axes</legend>
        {table && <AxisTable group={table} rows={rows} />}
      </fieldset>
      {folds.map((group) => (
        <AxisFold
          key={group.title}
          group={group}
          rows={rows}
          note={(index) =>
            group.fields.some(({ path }) => path.startsWith("limits.")) && (
              <div className={`${css.limitNote} hint regular`}>
                {inMechanics(draft.axes[index] ?? {}, scales[index])}
              </div>
            )
          }
        />
      ))}
      <div className={`${css.results} stack gap-6 mt-8`}>
        <TestResult
          test={test.data}
          error={test.error}
          pending={test.isPending}
          current={testedLink === link}
          emulated={draft.kind === "emulator"}
          emulate={emulateCommand(draft)}
        />
        {save.isError && <ProblemAlert error={save.error} doing={device ? "Saving" : "Adding"} />}
      </div>
      {interrupts && <p className="hint m-0 mt-4">The link changes: {device?.name} is stopped and connected anew.</p>}
      {tried && Object.keys(all).length > 0 && (
        <p className="m-0 mt-4 fault text-12" role="alert">
          Not saved yet: {Object.keys(all).length === 1 ? "one field needs" : `${Object.keys(all).length} fields need`}{" "}
          a look.
        </p>
      )}
      <Group gap="xs" mt="sm">
        <Button type="submit" loading={save.isPending}>
          {device ? "Save" : "Add and connect"}
        </Button>
        <Button variant="default" loading={test.isPending} onClick={runTest}>
          Test the link
        </Button>
        <Button variant="subtle" color="gray" onClick={onClose}>
          Cancel
        </Button>
      </Group>
    </form>
  );
}

/** How to serve an emulated device where this link leads to; null where that is no socket. */
function emulateCommand(draft: Draft): string | null {
  if (draft.kind !== "tcp") return null;
  const { host = "", port = "" } = linkValues(draft);
  return `stepscope emulate ${draft.model.name} --tcp ${host.trim()}:${port.trim()}`;
}

/** A new form begins at the name, unless one is proposed. Stable, so that it runs once. */
function focusIfEmpty(input: HTMLInputElement | null): void {
  if (input?.value === "") input.focus({ preventScroll: true });
}
