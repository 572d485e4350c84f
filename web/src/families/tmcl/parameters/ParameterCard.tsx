import { Button } from "@mantine/core";
import { IconArrowBackUp } from "@tabler/icons-react";
import { memo } from "react";
import common from "../../../lib/rows/rows.module.css";
import { keyOf } from "../../../lib/rows/staging";
import { Memory } from "./Memory";
import { ParameterHelp } from "./ParameterHelp";
import { Entry, Lacking, type LineProps, Meaning, Name, Value } from "./ParameterLine";
import { controlOf, OnDemand } from "./ParameterValue";
import { nameText } from "./subjects";

/** One parameter on a phone: its value with its control; help and what else can be done when opened. */
export const ParameterCard = memo(function ParameterCard(props: LineProps & { expanded: boolean }) {
  const { row, edit, lacking, editing, expanded, actions } = props;
  const key = keyOf(row);
  return (
    <li
      className={`${common.card} box`}
      data-row={key}
      data-staged={edit !== null}
      data-fate={edit?.fate?.kind}
      data-lacking={lacking || undefined}
    >
      <button
        type="button"
        className="plain pad w-full"
        aria-expanded={expanded}
        onClick={() => {
          actions.select(key);
          actions.toggle(key);
        }}
      >
        <span className="row gap-8 shrink">
          <Name row={row} />
          <span className="num dim push">{row.alias}</span>
        </span>
      </button>
      <div className="lines-12 mid pad">
        {lacking ? (
          <Lacking />
        ) : row.read_clears ? (
          <OnDemand
            row={row}
            asked={props.asked}
            busy={props.asking}
            connected={props.connected}
            onRead={() => actions.read(row)}
          />
        ) : editing ? (
          <Entry {...props} />
        ) : (
          <>
            <Value {...props} />
            <Meaning {...props} />
          </>
        )}
      </div>
      {expanded && (
        <div className="stack start gap-8 pad">
          <span className="row wrap gap-6">
            {controlOf(row) === "entry" && !editing && !lacking && (
              <Button size="compact-sm" variant="light" onClick={() => actions.edit(key)}>
                Edit the value
              </Button>
            )}
            {edit && (
              <Button
                size="compact-sm"
                variant="subtle"
                leftSection={<IconArrowBackUp size={14} aria-hidden />}
                aria-label={`Discard the edit of ${nameText(row.name)}`}
                onClick={() => actions.unstage(key)}
              >
                Discard the staged edit
              </Button>
            )}
            {!lacking && (
              <Memory
                row={row}
                kept={props.kept}
                busy={props.copying}
                connected={props.connected}
                onCopy={(action) => actions.copy(row, action)}
              />
            )}
          </span>
          <ParameterHelp row={row} context={props.context} lacking={lacking} />
        </div>
      )}
    </li>
  );
});
