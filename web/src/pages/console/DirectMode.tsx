import { Alert } from "@mantine/core";
import { useLocalStorage } from "@mantine/hooks";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useMemo, useState } from "react";
import { api, problemOf } from "../../api/client";
import { type Device, useCatalogModel } from "../../api/queries";
import { Card } from "../../lib/Card";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Catalog } from "./Catalog";
import { CommandLine } from "./CommandLine";
import { Entries } from "./Entries";
import { linesOf, remember, useHistory } from "./history";

/** Commands to a module as they are, and its answers byte by byte. */
export function DirectMode({ device }: { device: Device }) {
  const queries = useQueryClient();
  const catalog = useCatalogModel(device.model);
  const entries = useHistory(device.id);
  const lines = useMemo(() => linesOf(entries), [entries]);
  const [text, setText] = useState("");
  const [warned, setWarned] = useLocalStorage({ key: "stepscope.console.warned", defaultValue: false });
  const send = useMutation({
    // one after another, in the order in which they were entered: none is lost because the one before is under way
    scope: { id: `console of ${device.id}` },
    mutationFn: (line: string) =>
      api.POST("/api/v1/devices/{device}/tmcl", { path: { device: device.id }, body: { line } }),
    onSuccess: (answer, line) => remember(device.id, { line, answer, problem: null }),
    onError: (error, line) => {
      remember(device.id, { line, answer: null, problem: problemOf(error) });
      setText((next) => (next === "" ? line : next));
    },
    onSettled: () => {
      void queries.invalidateQueries({ queryKey: ["registers", device.id] });
      void queries.invalidateQueries({ queryKey: ["devices"] });
    },
  });
  const commands = catalog.data?.commands ?? [];

  return (
    <Card title="Direct mode" note="one command, one answer">
      {!warned && (
        <Alert p="xs" mb="xs" role="note" withCloseButton closeButtonLabel="Understood" onClose={() => setWarned(true)}>
          What you send goes to the module as it is. Commands marked “moves the motor” may set it in motion at once:
          keep STOP in reach.
        </Alert>
      )}
      {catalog.isError && (
        <ProblemAlert error={catalog.error} doing="Reading the commands" retry={() => void catalog.refetch()} />
      )}
      <CommandLine
        commands={commands}
        rows={catalog.data?.rows ?? []}
        lines={lines}
        text={text}
        onText={setText}
        connected={device.state === "connected" || device.heldBack}
        loading={catalog.isPending}
        busy={send.isPending}
        onSend={(line) => {
          setText("");
          send.mutate(line);
        }}
      />
      {commands.length > 0 && <Catalog commands={commands} onTake={setText} />}
      <div className="mt-8">
        <Entries device={device.id} entries={entries} onAgain={setText} />
      </div>
    </Card>
  );
}
