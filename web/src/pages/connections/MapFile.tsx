import { Button, FileButton, Text } from "@mantine/core";
import { IconFileImport } from "@tabler/icons-react";
import { useEffect, useRef, useState } from "react";
import { ProblemAlert } from "../../lib/ProblemAlert";
import { Findings, findingsOf } from "./MapFindings";
import type { Model } from "./models";
import { useChangeMaps } from "./useRegisterMaps";

interface Props {
  models: readonly Model[];
  /** the file is a model now */
  onModel: (model: Model) => void;
}

/** A register map of one's own as the model of the device that is being added; what is wrong with it line by line. */
export function MapFile({ models, onModel }: Props) {
  const { keep } = useChangeMaps();
  const again = useRef<() => void>(null);
  const [made, setMade] = useState<string | null>(null);
  const latest = useRef(onModel);
  latest.current = onModel;
  useEffect(() => {
    const model = models.find(({ name }) => name === made); // the catalog has it a moment later
    if (!model) return;
    setMade(null);
    latest.current(model);
  }, [models, made]);
  const file = keep.variables;
  return (
    <div className="mt-4">
      <FileButton
        resetRef={again}
        accept=".toml,.csv,.tsv"
        onChange={(chosen) => {
          again.current?.(); // the same file may be chosen again, after the user has mended it
          if (chosen) keep.mutate(chosen, { onSuccess: ({ name }) => setMade(name) });
        }}
      >
        {(props) => (
          <Button
            {...props}
            size="compact-xs"
            variant="subtle"
            loading={keep.isPending}
            leftSection={<IconFileImport size={14} aria-hidden />}
          >
            A chip of your own, from a register map
          </Button>
        )}
      </FileButton>
      {keep.isSuccess && file && (
        <Text size="xs" role="status">
          {keep.data.title}: {keep.data.registers} registers, from {file.name}.
        </Text>
      )}
      {keep.isError && (
        <>
          <ProblemAlert
            error={keep.error}
            doing={file ? `Reading ${file.name}` : "Reading the file"}
            onClose={() => keep.reset()}
          />
          {file && <Findings findings={findingsOf(keep.error)} of={file.name} />}
        </>
      )}
    </div>
  );
}
