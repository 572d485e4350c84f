import { Button, FileButton, Group, Text } from "@mantine/core";
import { IconFileImport } from "@tabler/icons-react";
import { useEffect, useRef, useState } from "react";
import { Card } from "../../lib/Card";
import { saveText } from "../../lib/files";
import { ProblemAlert } from "../../lib/ProblemAlert";
import css from "./connections.module.css";
import { Findings, findingsOf } from "./MapFindings";
import { fetchMap, type RegisterMap, useChangeMaps, useRegisterMaps } from "./useRegisterMaps";

interface Props {
  /** opens the form for a device of that model */
  onAdd: (model: string) => void;
}

/** Register maps: files that make a chip of one's own a model, dropped anywhere onto the page, or chosen. */
export function RegisterMaps({ onAdd }: Props) {
  const maps = useRegisterMaps();
  const { keep, remove } = useChangeMaps();
  const [failed, setFailed] = useState<unknown>(null);
  const again = useRef<() => void>(null);
  const take = async (files: readonly File[]) => {
    again.current?.(); // the same file may be chosen again, after the user has mended it
    keep.reset();
    for (const file of files) {
      try {
        await keep.mutateAsync(file);
      } catch {
        return; // shown below; the first that is not right keeps the others from being missed
      }
    }
  };
  const dropping = useDropped((files) => void take(files));
  return (
    <Card
      title="Your register maps"
      className={`${css.box} ${dropping ? css.dropping : ""} pad`}
      actions={
        <FileButton resetRef={again} multiple accept=".toml,.csv,.tsv" onChange={(files) => void take(files)}>
          {(props) => (
            <Button
              {...props}
              size="compact-xs"
              variant="default"
              loading={keep.isPending}
              leftSection={<IconFileImport size={14} aria-hidden />}
            >
              Open a file
            </Button>
          )}
        </FileButton>
      }
    >
      <p className="hint m-0">
        A file that says what registers a chip has makes it a model here: an FPGA, a clone, a chip that nobody lists.
        Drop it onto this page: TOML, or a table as CSV.
      </p>
      {keep.isError && (
        <div className="mt-8">
          <ProblemAlert
            error={keep.error}
            doing={keep.variables ? `Reading ${keep.variables.name}` : "Reading the file"}
            onClose={() => keep.reset()}
          />
          {keep.variables && <Findings findings={findingsOf(keep.error)} of={keep.variables.name} />}
        </div>
      )}
      {keep.isSuccess && keep.variables && (
        <Text size="xs" mt={6} role="status">
          {keep.data.title} is a model now: {keep.data.registers} registers, from {keep.variables.name}.
        </Text>
      )}
      {maps.isError && (
        <ProblemAlert error={maps.error} doing="Looking for register maps" retry={() => void maps.refetch()} />
      )}
      {remove.isError && <ProblemAlert error={remove.error} doing="Deleting" onClose={() => remove.reset()} />}
      {failed !== null && <ProblemAlert error={failed} doing="Downloading" onClose={() => setFailed(null)} />}
      <ul className={`${css.ports} list`} aria-label="Register maps">
        {maps.data?.maps.map((map) => (
          <li key={map.name}>
            <Entry
              map={map}
              deleting={remove.isPending && remove.variables === map.name}
              onAdd={() => onAdd(map.name)}
              onDelete={() => remove.mutate(map.name)}
              onDownload={() => {
                fetchMap(map.name).then((text) => saveText(`${map.name}.toml`, text), setFailed);
              }}
            />
          </li>
        ))}
      </ul>
      {maps.data?.passed_over.map((line) => (
        <p key={line} className="hint m-0 mt-4">
          Passed over: {line}
        </p>
      ))}
    </Card>
  );
}

interface EntryProps {
  map: RegisterMap;
  deleting: boolean;
  onAdd: () => void;
  onDelete: () => void;
  onDownload: () => void;
}

function Entry({ map, deleting, onAdd, onDelete, onDownload }: EntryProps) {
  const usable = map.findings.length === 0;
  return (
    <div className="grow">
      <Group justify="space-between" gap={6}>
        <span>
          <b>{usable ? map.title : map.name}</b>
          <span className="hint block">
            {usable ? (
              <>
                {map.name} · <span className="num">{map.registers}</span> registers
                {map.devices.length > 0 && ` · used by ${map.devices.join(", ")}`}
              </>
            ) : (
              "cannot be read"
            )}
          </span>
        </span>
        <Group gap={4} wrap="nowrap">
          {usable && (
            <Button size="compact-xs" variant="default" aria-label={`Add a ${map.title}`} onClick={onAdd}>
              Add
            </Button>
          )}
          <Button
            size="compact-xs"
            variant="subtle"
            color="gray"
            aria-label={`Download ${map.name}`}
            onClick={onDownload}
          >
            Download
          </Button>
          <Button
            size="compact-xs"
            variant="subtle"
            color="gray"
            aria-label={`Delete ${map.name}`}
            loading={deleting}
            disabled={map.devices.length > 0}
            title={map.devices.length > 0 ? `used by ${map.devices.join(", ")}` : undefined}
            onClick={onDelete}
          >
            Delete
          </Button>
        </Group>
      </Group>
      {map.behind !== "" && (
        <Text size="xs" role="status">
          Its devices go by what it was: {map.behind}.
        </Text>
      )}
      <Findings findings={map.findings} more={map.more} of={map.name} />
    </div>
  );
}

/** Files that are dropped anywhere onto the page; whether some are held over it. */
function useDropped(take: (files: readonly File[]) => void): boolean {
  const [over, setOver] = useState(false);
  const latest = useRef(take);
  latest.current = take;
  useEffect(() => {
    const withFiles = (event: DragEvent) => event.dataTransfer?.types.includes("Files") === true;
    const hold = (event: DragEvent) => {
      if (!withFiles(event)) return;
      event.preventDefault(); // else the browser would leave the page for the file
      setOver(true);
    };
    const leave = (event: DragEvent) => {
      if (event.relatedTarget === null) setOver(false);
    };
    const drop = (event: DragEvent) => {
      setOver(false);
      if (!withFiles(event)) return;
      event.preventDefault();
      latest.current([...(event.dataTransfer?.files ?? [])]);
    };
    window.addEventListener("dragover", hold);
    window.addEventListener("dragleave", leave);
    window.addEventListener("drop", drop);
    return () => {
      window.removeEventListener("dragover", hold);
      window.removeEventListener("dragleave", leave);
      window.removeEventListener("drop", drop);
    };
  }, []);
  return over;
}
