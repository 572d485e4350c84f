import {
  ActionIcon,
  Button,
  Group,
  Menu,
  Modal,
  Select,
  Stack,
  TagsInput,
  Text,
  Textarea,
  TextInput,
} from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { IconDotsVertical, IconDownload, IconFileText, IconPencil, IconTrash } from "@tabler/icons-react";
import { useState } from "react";
import type { Schemas } from "../../api/client";
import { useAddress } from "../../lib/address";
import { sizeText } from "../../lib/format";
import { downloadHref, isRunning, type Recording, reportHref, titleOf, useChanges } from "./api";
import { COLOURS } from "./compare";
import type { Window } from "./ZoomData";

interface Props {
  recording: Recording;
  attempt: (doing: string, work: () => Promise<unknown>) => void;
  /** the stretch that is shown of it; null: all */
  window?: Window | null;
  /** after it is gone */
  onRemoved?: () => void;
}

/** What can be done with a recording that is there: taken along, called otherwise, deleted. */
export function RowMenu({ recording, attempt, window = null, onRemoved }: Props) {
  const [naming, naming_] = useDisclosure();
  const [deleting, deleting_] = useDisclosure();
  const changes = useChanges();
  const { predict } = useAddress("predict");
  const title = titleOf(recording);
  const readable = recording.device !== null;
  return (
    <>
      <Menu position="bottom-end" shadow="md" withinPortal>
        <Menu.Target>
          <ActionIcon size={26} aria-label={`More for ${title}`}>
            <IconDotsVertical size={16} />
          </ActionIcon>
        </Menu.Target>
        <Menu.Dropdown>
          {readable &&
            (["csv", "parquet"] as const).map((format) => (
              <Menu.Item
                key={format}
                component="a"
                href={downloadHref(recording.id, format)}
                download
                leftSection={<IconDownload size={15} aria-hidden />}
              >
                {format === "csv" ? "CSV" : "Parquet"}
              </Menu.Item>
            ))}
          {readable && (
            <Menu.Item
              component="a"
              href={reportHref(recording.id, window, predict)}
              download
              leftSection={<IconFileText size={15} aria-hidden />}
            >
              {window ? "Report of what is shown" : "Report"}
            </Menu.Item>
          )}
          <Menu.Item leftSection={<IconPencil size={15} aria-hidden />} onClick={naming_.open}>
            Name and note
          </Menu.Item>
          <Menu.Item
            color="red"
            leftSection={<IconTrash size={15} aria-hidden />}
            disabled={isRunning(recording)}
            onClick={deleting_.open}
          >
            Delete
          </Menu.Item>
        </Menu.Dropdown>
      </Menu>
      <Modal opened={naming} onClose={naming_.close} title="Name and note" size="sm">
        <LabelForm
          recording={recording}
          onDone={(label) => {
            naming_.close();
            attempt("Renaming", () => changes.label(recording.id, label));
          }}
        />
      </Modal>
      <Modal opened={deleting} onClose={deleting_.close} title={`Delete ${title}?`} size="sm">
        <Stack gap="sm">
          <Text size="sm">
            {sizeText(recording.size_bytes)} of samples and marks go for good; there is no way back.
          </Text>
          <Group justify="flex-end" gap="xs">
            <Button variant="default" onClick={deleting_.close} data-autofocus>
              Keep it
            </Button>
            <Button
              color="red"
              onClick={() => {
                deleting_.close();
                attempt(`Deleting ${title}`, () => changes.remove(recording.id).then(() => onRemoved?.()));
              }}
            >
              Delete
            </Button>
          </Group>
        </Stack>
      </Modal>
    </>
  );
}

function LabelForm({
  recording,
  onDone,
}: {
  recording: Recording;
  onDone: (label: Schemas["RecordingLabel"]) => void;
}) {
  const [name, setName] = useState(recording.name);
  const [note, setNote] = useState(recording.note);
  const [tags, setTags] = useState(recording.tags);
  const [colour, setColour] = useState(recording.colour);
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        onDone({ name: name.trim(), note, tags, colour: COLOURS.find((each) => each === colour) ?? "" });
      }}
    >
      <Stack gap="sm">
        <TextInput
          size="sm"
          label="Name"
          data-autofocus
          maxLength={100}
          value={name}
          placeholder={recording.id}
          onChange={(event) => setName(event.currentTarget.value)}
        />
        <Textarea
          label="Note"
          autosize
          minRows={3}
          maxRows={12}
          maxLength={4000}
          value={note}
          onChange={(event) => setNote(event.currentTarget.value)}
        />
        <TagsInput
          size="sm"
          label="Tags"
          description="Words that a search finds it by; Enter ends one"
          maxTags={12}
          value={tags}
          onChange={setTags}
        />
        <Select
          size="sm"
          label="Colour in comparisons"
          data={[{ value: "", label: "by its place" }, ...COLOURS.map((name) => ({ value: name, label: name }))]}
          value={colour}
          allowDeselect={false}
          onChange={(value) => setColour(value ?? "")}
        />
        <Group justify="flex-end">
          <Button type="submit">Save</Button>
        </Group>
      </Stack>
    </form>
  );
}
