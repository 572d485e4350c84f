import { Button, Tabs, Text, Tooltip } from "@mantine/core";
import { IconCode, IconDownload } from "@tabler/icons-react";
import { type KeyboardEvent, useDeferredValue, useMemo, useRef, useState } from "react";
import { api, problemOf } from "../../api/client";
import { can, type Device } from "../../api/queries";
import { Card } from "../../lib/Card";
import { NoDevice, Waiting } from "../../lib/NoDevice";
import { Page } from "../../lib/Page";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { DeviceNotice } from "../../lib/rows/DeviceNotice";
import { usePhone } from "../../lib/usePhone";
import { useSelectedAxis } from "../../live/selection";
import { type Command, commandOf, KEYS } from "./commands";
import { useDraft } from "./draft";
import { Editor, type EditorHandle } from "./Editor";
import { FileMenu } from "./FileMenu";
import { Listing } from "./Listing";
import { addressAt, addressesOf } from "./lines";
import css from "./program.module.css";
import { StatePanel } from "./StatePanel";
import { Toolbar } from "./Toolbar";
import { TracePanel } from "./TracePanel";
import { TrialPanel } from "./TrialPanel";
import { bodyOf, useCheck, useWatch, useWords } from "./usePrograms";
import { useRun } from "./useRun";
import type { Help, Problem } from "./words";

/** The program of a module: written, checked while it is written, stored, run and debugged. */
export default function ProgramPage() {
  const { waiting, device } = useSelectedAxis();
  if (waiting) return <Waiting page="Program" />;
  if (!device || !can(device, "programs"))
    return <NoDevice page="Program" icon={<IconCode size={22} />} wanted="a module that executes programs" />;
  return (
    <Page name="Program">
      <DeviceNotice device={device} />
      <Workbench key={device.id} device={device} />
    </Page>
  );
}

const NO_PROBLEMS: readonly Problem[] = [];

function Workbench({ device }: { device: Device }) {
  const phone = usePhone();
  const connected = device.state === "connected";
  const [draft, change] = useDraft(device.id);
  const { words, error: wordsError, retry } = useWords(device);
  const [tab, setTab] = useState<string | null>("problems");
  const check = useCheck(device.id, draft.name, draft.text, tab === "listing");
  const watch = useWatch(device.id, draft.variables);
  const { run, doing } = useRun(device.id);
  const [help, setHelp] = useState<Help | null>(null);
  const [from, setFrom] = useState("");
  const [failed, setFailed] = useState<{ doing: string; error: unknown } | null>(null);
  const [busy, setBusy] = useState(false);
  const [done, setDone] = useState("");
  const editor = useRef<EditorHandle>(null);

  const { result: checked } = check;
  const fresh = checked !== undefined && !check.stale;
  const problems = checked?.problems ?? NO_PROBLEMS;
  const listed = useDeferredValue(problems); // after the marks in the text, which are waited for
  const { stored } = draft;
  const isStored = stored !== null && stored.text === draft.text;
  // What the module has is what was stored; of a text that was changed since, nothing is said.
  const lines = isStored ? stored.lines : (fresh && checked.lines) || [];
  const labels = isStored ? stored.labels : check.labels;
  const stepping = watch.seen?.debug.state === "running";
  const currentLine =
    isStored && watch.seen !== null && watch.lost === "" ? stored.lines[watch.seen.counter] || null : null;
  const breakpoints = useMemo(() => addressesOf(lines, draft.breakpoints), [lines, draft.breakpoints]);

  function attempt(what: string, work: () => Promise<void>) {
    setBusy(true);
    setDone("");
    void work()
      .then(() => setFailed(null))
      .catch((error: unknown) => setFailed({ doing: what, error }))
      .finally(() => setBusy(false));
  }

  function download() {
    const { name, text } = draft;
    attempt("Downloading", async () => {
      const answer = await api.PUT("/api/v1/devices/{device}/program", {
        path: { device: device.id },
        body: bodyOf(name, text),
      });
      const made = await api.POST("/api/v1/devices/{device}/program/assemble", {
        path: { device: device.id },
        body: { ...bodyOf(name, text), listing: false, binary: false },
      });
      change({ stored: { text, lines: made.lines, labels: made.labels } });
      setFrom("0");
      setDone(`${answer.commands} commands stored and read back`);
    });
  }

  const cannotRun =
    breakpoints.length > 0 && from !== "" && from !== "0"
      ? "With breakpoints a run begins where the program is, or at its start: a module goes to no other address without running from it"
      : "";

  function obey(command: Command) {
    setDone("");
    if (command === "breakpoint") editor.current?.toggleBreakpoint();
    else if (command === "download") download();
    else if (command === "run") {
      if (cannotRun !== "") return;
      if (breakpoints.length > 0) run.mutate({ do: "debug", mode: "run", breakpoints, fromStart: from === "0" });
      else run.mutate({ do: "run", address: from === "" ? null : Number(from) });
      setFrom("");
    } else if (command === "over" || command === "out")
      run.mutate({ do: "debug", mode: command, breakpoints, fromStart: false });
    else if (command === "cursor") {
      const address = addressAt(lines, editor.current?.cursorLine() ?? 1);
      if (address !== null)
        run.mutate({ do: "debug", mode: "run", breakpoints: [...breakpoints, address], fromStart: from === "0" });
      setFrom("");
    } else run.mutate({ do: command });
  }

  function onKeyDown(event: KeyboardEvent) {
    const command = commandOf(event);
    if (command === null) return;
    event.preventDefault();
    const always = command === "breakpoint" || command === "stop" || command === "pause";
    if (always || (connected && !stepping && !busy && !phone)) obey(command);
  }

  const verdict = check.error
    ? `not checked: ${problemOf(check.error).detail}`
    : !fresh
      ? "…"
      : problems.length > 0
        ? `${problems.length} ${problems.length === 1 ? "problem" : "problems"}`
        : `${checked.commands} of 2048 commands`;
  const told = isStored ? "as it was downloaded" : stored ? "changed since the download" : "not downloaded from here";

  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: keys of what is inside, as they come up
    <div className={`${css.page} columns until-75`} onKeyDown={onKeyDown}>
      <div className="grid shrink gap-8">
        <Card
          title={draft.name}
          note={
            <>
              <span data-testid="verdict" className={problems.length > 0 ? css.problem : undefined}>
                {verdict}
              </span>
              {" · "}
              {told}
            </>
          }
          actions={
            !phone && (
              <>
                <FileMenu
                  device={device.id}
                  connected={connected}
                  name={draft.name}
                  text={draft.text}
                  attempt={attempt}
                  onOpen={(name, text) => {
                    change({ name, breakpoints: [] });
                    editor.current?.setText(text);
                  }}
                />
                <Tooltip label={`Store it in the module and read it back (${KEYS.download})`}>
                  <Button
                    leftSection={<IconDownload size={16} aria-hidden />}
                    aria-keyshortcuts={KEYS.download}
                    loading={busy}
                    disabled={!connected || !fresh || problems.length > 0 || checked.commands === 0}
                    onClick={download}
                  >
                    Download
                  </Button>
                </Tooltip>
              </>
            )
          }
        >
          <div className="grid gap-8">
            {!phone && (
              <Toolbar
                labels={labels}
                from={from}
                onFrom={setFrom}
                stepping={stepping}
                disabled={!connected || busy}
                cannotRun={cannotRun}
                onCommand={obey}
              />
            )}
            {failed && <ProblemAlert {...failed} onClose={() => setFailed(null)} />}
            {run.isError && <ProblemAlert error={run.error} doing={doing} onClose={run.reset} />}
            {wordsError != null && <ProblemAlert error={wordsError} doing="Reading the language" retry={retry} />}
            {breakpoints.length > 0 && !phone && (
              <Text className="hint" role="note">
                With breakpoints the program runs by single steps: slower than real time, while motor and timers do not
                wait. The module has breakpoints of its own (command 141), but no public source tells how to set them.
              </Text>
            )}
            <Editor
              ref={editor}
              text={draft.text}
              words={words}
              problems={problems}
              breakpoints={draft.breakpoints}
              currentLine={currentLine}
              readOnly={phone}
              onText={(text) => change({ text })}
              onBreakpoints={(found) => change({ breakpoints: found })}
              onHelp={setHelp}
            />
            <Text className={`${css.help} hint`} aria-live="polite" data-testid="program-help">
              {help ? (
                <>
                  <b>{help.title}</b> {help.text}
                </>
              ) : draft.text === "" ? (
                "An empty program. File has examples."
              ) : phone ? (
                "Here to be read: it is written on a larger screen."
              ) : (
                `Tab leaves the text, ${navigator.platform.startsWith("Mac") ? "⌘" : "Ctrl"} ] indents; F9 sets a breakpoint, Ctrl Space proposes what could stand here.`
              )}
            </Text>
            {done !== "" && (
              <Text size="sm" role="status">
                {done}
              </Text>
            )}
          </div>
        </Card>
        <Card className="pad">
          <Tabs value={tab} onChange={setTab} keepMounted={false}>
            <Tabs.List>
              <Tabs.Tab value="problems">{`Problems (${problems.length})`}</Tabs.Tab>
              <Tabs.Tab value="listing">Listing</Tabs.Tab>
              <Tabs.Tab value="trial">Trial</Tabs.Tab>
            </Tabs.List>
            <Tabs.Panel value="problems" pt="xs">
              {listed.length === 0 ? (
                <Text className="hint">Nothing is wrong as far as an assembler can tell.</Text>
              ) : (
                <ul className={`${css.scrolled} list text-13`} aria-label="Problems">
                  {listed.map((problem) => (
                    <li key={`${problem.file}:${problem.line}:${problem.column}:${problem.message}`}>
                      <button
                        type="button"
                        className="plain lit w-full"
                        onClick={() => editor.current?.goTo(problem.line, problem.column)}
                      >
                        <span className="num dim">
                          {problem.file === draft.name ? "" : `${problem.file} `}
                          {problem.line}:{problem.column}
                        </span>{" "}
                        {problem.message}
                      </button>
                    </li>
                  ))}
                </ul>
              )}
            </Tabs.Panel>
            <Tabs.Panel value="listing" pt="xs">
              <Listing text={fresh ? checked.listing : ""} counter={isStored ? (watch.seen?.counter ?? null) : null} />
            </Tabs.Panel>
            <Tabs.Panel value="trial" pt="xs">
              <TrialPanel
                device={device.id}
                name={draft.name}
                text={draft.text}
                labels={check.labels}
                ready={connected && fresh && problems.length === 0 && checked.commands > 0}
              />
            </Tabs.Panel>
          </Tabs>
        </Card>
      </div>
      <div className="column">
        <StatePanel
          watch={watch}
          labels={labels}
          variables={draft.variables}
          onVariables={(variables) => change({ variables })}
        />
        <TracePanel watch={watch} labels={labels} />
      </div>
    </div>
  );
}
