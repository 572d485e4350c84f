import { ActionIcon, Button, Drawer, Group, Skeleton, Text } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { IconEngine, IconPencil, IconPlus, IconTrash } from "@tabler/icons-react";
import { useEffect, useRef, useState } from "react";
import type { Schemas } from "../../api/client";
import { EmptyState } from "../EmptyState";
import { ProblemAlert } from "../ProblemAlert";
import { ChangeForm } from "./ChangeForm";
import type { MeasuredFigure } from "./changes";
import { draftOf, figuresOf, figuresText, type MotorDraft, NEW_MOTOR } from "./figures";
import { MotorForm } from "./MotorForm";
import classes from "./motors.module.css";
import { useDeleteMotor, useKeepMotor, useOwnMotors } from "./useOwnMotors";

type NamedMotor = Schemas["MotorInfo"];

interface Props {
  /** a motor to begin with, which is not kept yet */
  draft?: MotorDraft;
  /** what was measured of a motor, for one of them to take up */
  measured?: readonly MeasuredFigure[];
  /** takes one of them where the button stands */
  onUse?: (motor: NamedMotor) => void;
}

/** Opens the motors of one's own beside the page: to take one, to add, edit and delete them. */
export function MyMotorsButton({ label = "My motors", ...motors }: Props & { label?: string }) {
  const [opened, { open, close }] = useDisclosure();
  const { onUse } = motors;
  return (
    <>
      <Button variant="default" onClick={open}>
        {label}…
      </Button>
      <Drawer
        opened={opened}
        onClose={close}
        position="right"
        size="md"
        title="My motors"
        closeButtonProps={{ "aria-label": "Close my motors" }}
      >
        {opened && (
          <MyMotors
            {...motors}
            {...(onUse && {
              onUse: (motor: NamedMotor) => {
                close();
                onUse(motor);
              },
            })}
          />
        )}
      </Drawer>
    </>
  );
}

interface Edited {
  start: MotorDraft;
  /** its name as it is kept; null: a new one */
  name: string | null;
}

function MyMotors({ draft, measured, onUse }: Props) {
  const { data: motors, error, refetch } = useOwnMotors();
  const [edited, setEdited] = useState<Edited | null>(draft ? { start: draft, name: null } : null);
  const [changing, setChanging] = useState<NamedMotor | null>(null);
  const [changed, setChanged] = useState("");
  if (motors === undefined)
    return error ? (
      <ProblemAlert error={error} doing="Reading your motors" retry={() => void refetch()} />
    ) : (
      <Skeleton height={160} aria-label="Reading your motors" />
    );
  if (edited)
    return (
      <MotorForm
        start={edited.start}
        edited={edited.name}
        taken={motors.map(({ name }) => name).filter((name) => name !== edited.name)}
        onEnd={() => setEdited(null)}
      />
    );
  if (changing && measured)
    return (
      <ChangeForm
        motor={changing}
        measured={measured}
        onEnd={(done) => {
          setChanged(done ? changing.name : "");
          setChanging(null);
        }}
      />
    );
  return (
    <MotorList
      motors={motors}
      changed={changed}
      onEdit={(start, name) => setEdited({ start, name })}
      {...(measured && { onChange: setChanging })}
      {...(onUse && { onUse })}
    />
  );
}

interface ListProps extends Pick<Props, "onUse"> {
  motors: readonly NamedMotor[];
  /** the one that has just taken up what was measured of it; empty: none */
  changed: string;
  onEdit: (start: MotorDraft, name: string | null) => void;
  /** shows what would change of one */
  onChange?: (motor: NamedMotor) => void;
}

function MotorList({ motors, changed, onEdit, onChange, onUse }: ListProps) {
  const keep = useKeepMotor();
  const remove = useDeleteMotor();
  const [deleted, setDeleted] = useState<MotorDraft | null>(null);
  const add = useRef<HTMLButtonElement>(null);
  useEffect(() => add.current?.focus(), []);
  const putBack = (motor: MotorDraft) => {
    const figures = figuresOf(motor);
    if (figures === null) return;
    const onSuccess = () => {
      setDeleted(null);
      add.current?.focus();
    };
    keep.mutate({ name: motor.name, figures }, { onSuccess });
  };
  return (
    <div className="column">
      <Group>
        <Button
          ref={add}
          data-autofocus
          leftSection={<IconPlus size={15} aria-hidden />}
          onClick={() => onEdit(NEW_MOTOR, null)}
        >
          Add a motor
        </Button>
      </Group>
      {changed && !deleted && (
        <Text size="sm" role="status" className="anywhere">
          {changed} is changed.
        </Text>
      )}
      {deleted && (
        <Group gap="xs" role="status">
          <Text size="sm" className="anywhere">
            {deleted.name} is deleted.
          </Text>
          <Button
            key={deleted.name}
            ref={atOnce}
            size="compact-sm"
            variant="default"
            loading={keep.isPending}
            onClick={() => putBack(deleted)}
          >
            Undo
          </Button>
        </Group>
      )}
      <ProblemAlert error={remove.error} doing="Deleting the motor" onClose={() => remove.reset()} />
      <ProblemAlert error={keep.error} doing="Keeping the motor" onClose={() => keep.reset()} />
      {motors.length === 0 ? (
        <EmptyState title="None of your own yet" icon={<IconEngine size={22} />}>
          <Text size="sm" className="dim">
            A motor that the data base does not know, or whose data sheet tells more than that does: its figures are
            kept on this server, and it is found by its name wherever a motor is asked for.
          </Text>
        </EmptyState>
      ) : (
        <ul className="list" aria-label="My motors">
          {motors.map((motor) => (
            <li key={motor.name} className={`${classes.motor} row gap-8`}>
              <div className="grow shrink anywhere">
                <b className="text-14">{motor.name}</b>
                <div className="text-13 dim">{figuresText(motor)}</div>
              </div>
              {onChange && (
                <Button
                  size="compact-sm"
                  variant="default"
                  aria-label={`Change ${motor.name}`}
                  onClick={() => onChange(motor)}
                >
                  Change…
                </Button>
              )}
              {onUse && (
                <Button
                  size="compact-sm"
                  variant="default"
                  aria-label={`Use ${motor.name}`}
                  onClick={() => onUse(motor)}
                >
                  Use
                </Button>
              )}
              <ActionIcon aria-label={`Edit ${motor.name}`} onClick={() => onEdit(draftOf(motor), motor.name)}>
                <IconPencil size={16} />
              </ActionIcon>
              <ActionIcon
                aria-label={`Delete ${motor.name}`}
                disabled={remove.isPending}
                onClick={() => remove.mutate(motor.name, { onSuccess: () => setDeleted(draftOf(motor)) })}
              >
                <IconTrash size={16} />
              </ActionIcon>
            </li>
          ))}
        </ul>
      )}
    </div>
  );
}

const atOnce = (button: HTMLButtonElement | null) => button?.focus();
