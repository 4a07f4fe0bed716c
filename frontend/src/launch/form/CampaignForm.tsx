// The form of a campaign by sections; rarely used ones are collapsed.
import type { Catalogue } from '../../client'
import { AboutForm } from './AboutForm'
import { CriterionForm } from './CriterionForm'
import { MethodsTable } from './MethodsTable'
import { hasScenario } from '../../api/campaign'
import type { Parameter } from '../campaign/parameters'
import { ProposalCard } from '../proposal/ProposalCard'
import { ScenarioForm } from './ScenarioForm'
import { SettingsForm } from './SettingsForm'
import { ResultForm, SimulatorForm } from './SimulatorForm'
import { UncertainTable } from './UncertainTable'
import type { Draft } from '../draft/useDraft'

interface CampaignFormProps {
  draft: Draft
  catalogue: Catalogue
  parameters: Parameter[]
}

export function CampaignForm({ draft, catalogue, parameters }: CampaignFormProps) {
  const { campaign, set, remove } = draft
  return (
    <>
      <UncertainTable campaign={campaign} parameters={parameters} set={set} />
      {hasScenario(campaign) ? (
        <CriterionForm campaign={campaign} catalogue={catalogue} set={set} remove={remove} />
      ) : (
        <ResultForm campaign={campaign} catalogue={catalogue} set={set} />
      )}
      {!hasScenario(campaign) && <ProposalCard campaign={campaign} catalogue={catalogue} set={set} />}
      <MethodsTable campaign={campaign} catalogue={catalogue} parameters={parameters} set={set} />
      <SettingsForm campaign={campaign} set={set} />
      {hasScenario(campaign) ? (
        <ScenarioForm campaign={campaign} catalogue={catalogue} set={set} remove={remove} />
      ) : (
        <SimulatorForm campaign={campaign} catalogue={catalogue} parameters={parameters} set={set} />
      )}
      <AboutForm campaign={campaign} set={set} />
    </>
  )
}
