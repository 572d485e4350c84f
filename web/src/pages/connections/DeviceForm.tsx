import { ActionIcon, Button, Group, SegmentedControl, Select, TextInput } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { type FormEvent, useState } from "react";
import type { Device } from "../../api/queries";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { scaleOf } from "../../lib/units";
import { AxesFields } from "./AxisFields";
import { ChipLinkFields } from "./ChipLinkFields";
import css from "./connections.module.css";
import { axisConfigs, type Draft, linkOf, moduleKind, problemsOf, withModel } from "./draft";
import { EmulatorOptions } from "./EmulatorOptions";
import { LimitFields } from "./LimitFields";
import { ModuleLinkFields } from "./ModuleLinkFields";
import { canModel, isModule, type Kind, kindsOf, NAMES_ONLY } from "./models";
import { TestResult } from "./TestResult";
import { ThresholdFields } from "./ThresholdFields";
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
  // An empty field is no mistake before one has tried to save; a wrong one is at once.
  const problem = (path: string, text: string) => (tried || text.trim() !== "" ? all[path] : undefined);
  const model = draft.model;
  const kind = moduleKind(draft);
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
      if (paths.some((path) => /^(stages|options|seed|timeScale)/.test(path))) setMore(true);
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
        <ActionIcon size={24} variant="subtle" color="gray" aria-label="Close without saving" onClick={onClose}>
          <IconX size={16} />
        </ActionIcon>
      </div>
      <div className={`${css.two} halves start gap-8`}>
        <TextInput
          size="xs"
          label="Name"
          placeholder="for example bench"
          ref={focusIfEmpty}
          classNames={{ label: "hint regular" }}
          value={draft.name}
          error={problem("name", draft.name)}
          maxLength={80}
          autoComplete="off"
          onChange={(event) => set({ name: event.currentTarget.value })}
        />
        <Select
          size="xs"
          label="Model"
          classNames={{ label: "hint regular" }}
          data={(catalog.data ?? [draft.model]).map(({ name, title, axes, tier }) => ({
            value: name,
            label: `${title} · ${axes === 1 ? "1 axis" : `${axes} axes`}${tier === "names" ? " · names only" : ""}`,
          }))}
          searchable
          nothingFoundMessage="No model of that name"
          description={model.tier === "names" ? NAMES_ONLY : undefined}
          value={draft.model.name}
          allowDeselect={false}
          disabled={device !== null}
          onChange={(name) => {
            const chosen = catalog.data?.find((candidate) => candidate.name === name);
            if (chosen) setDraft((now) => withModel(now, chosen));
          }}
        />
      </div>
      <fieldset className={`${css.group} stack gap-8 m-0 mt-12 rule-top`}>
        <legend>Link</legend>
        <SegmentedControl
          size="xs"
          fullWidth
          aria-label="Kind of link"
          data={kindsOf(draft.model)}
          value={draft.kind}
          onChange={(kind) =>
            set({ kind: kind as Kind, ...(kind === "tcp" && draft.host === "" ? { host: "127.0.0.1" } : {}) })
          }
        />
        {isModule(model) ? (
          kind === "emulator" ? (
            <EmulatorOptions
              model={model}
              options={draft.options}
              problem={problem}
              onChange={(options) => set({ options })}
              open={more}
              onOpen={setMore}
            />
          ) : (
            <ModuleLinkFields
              kind={kind}
              draft={draft.module}
              problem={problem}
              onChange={(change) => setDraft((now) => ({ ...now, module: { ...now.module, ...change } }))}
            />
          )
        ) : (
          <ChipLinkFields
            draft={draft}
            model={model}
            problems={all}
            problem={problem}
            onChange={set}
            more={more}
            onMore={setMore}
          />
        )}
      </fieldset>
      <AxesFields draft={draft} problems={all} strict={tried} onChange={(axes) => set({ axes })} />
      <LimitFields draft={draft} problems={all} scales={scales} onChange={(axes) => set({ axes })} />
      {canModel(model, "encoder") && (
        <ThresholdFields draft={draft} problems={all} onChange={(axes) => set({ axes })} />
      )}
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
        <Button size="xs" type="submit" loading={save.isPending}>
          {device ? "Save" : "Add and connect"}
        </Button>
        <Button size="xs" variant="default" loading={test.isPending} onClick={runTest}>
          Test the link
        </Button>
        <Button size="xs" variant="subtle" color="gray" onClick={onClose}>
          Cancel
        </Button>
      </Group>
    </form>
  );
}

/** How to serve an emulated device where this link leads to; null where that is no socket. */
function emulateCommand(draft: Draft): string | null {
  if (draft.kind !== "tcp") return null;
  const [host, port] = isModule(draft.model) ? [draft.module.host, draft.module.tcpPort] : [draft.host, draft.port];
  return `stepscope emulate ${draft.model.name} --tcp ${host.trim()}:${port.trim()}`;
}

/** A new form begins at the name, unless one is proposed. Stable, so that it runs once. */
function focusIfEmpty(input: HTMLInputElement | null): void {
  if (input?.value === "") input.focus({ preventScroll: true });
}
