import { fixed, hex, rounded } from "../../lib/format";
import { type EncConst, encConstValue, type Form, fractionText } from "./encConst";

interface Props {
  /** the word in the chip, with its sign where it has one; null while unknown */
  inChip: number | null;
  /** how the chip counts its fraction now, and how it will */
  heldDecimal: boolean;
  decimal: boolean;
  counts: number;
  microstepsPerTurn: number;
  /** null where there is no constant to be found */
  found: EncConst | null;
}

/** What a count of an encoder is worth: as the chip holds it, exactly, and as each of the two words. */
export function ConstFacts({ inChip, heldDecimal, decimal, counts, microstepsPerTurn, found }: Props) {
  return (
    <dl className="facts pairs m-0 mt-8 text-12" data-testid="enc-const">
      <dt title="ENC_CONST">in the chip</dt>
      <dd className="num breaks" data-testid="enc-const-chip">
        {inChip === null ? "–" : `${hex(inChip, 32)} = ${rounded(encConstValue(inChip, heldDecimal), 9)}`}
      </dd>
      {found && (
        <>
          <dt title={`for ${fixed(counts)} counts a turn`}>exactly</dt>
          <dd className="num breaks" data-testid="enc-const-exact">
            {fixed(microstepsPerTurn)}/{fixed(counts)} = {fractionText(found.exact)}
          </dd>
          <FormRow name="binary" form={found.binary} chosen={!decimal} better={found.better === "binary"} />
          <FormRow name="decimal" form={found.decimal} chosen={decimal} better={found.better === "decimal"} />
        </>
      )}
    </dl>
  );
}

function FormRow({ name, form, chosen, better }: { name: string; form: Form; chosen: boolean; better: boolean }) {
  const drift = form.driftPerTurn;
  return (
    <>
      <dt className={chosen ? "ink bold" : ""}>
        {name}
        {chosen && ", in use"}
        {better && !chosen && ", drifts less"}
      </dt>
      <dd className="num breaks" data-testid={`enc-const-${name}`}>
        {hex(form.raw, 32)}, {drift === 0 ? "no drift" : `${fixed(drift, 4)} µsteps a turn`}
      </dd>
    </>
  );
}
